// SPDX-License-Identifier: BSD-3-Clause
/// What every part of PhysX needs first: its foundation, which there may be one of in a program.
#pragma once

#include <foundation/PxAllocatorCallback.h>
#include <foundation/PxErrorCallback.h>
#include <foundation/PxFoundation.h>
#include <foundation/PxPhysicsVersion.h>

#include <cstdlib>
#include <stdexcept>

namespace bvlab {

class PhysxMemory final : public physx::PxAllocatorCallback {
 public:
  void* allocate(std::size_t size, const char*, const char*, int) override {
    return std::aligned_alloc(16, (size + 15) / 16 * 16);
  }
  void deallocate(void* memory) override { std::free(memory); }
};

/// Its warnings are of inputs that are unusual; what fails returns nothing, which is looked at.
class PhysxSilence final : public physx::PxErrorCallback {
 public:
  void reportError(physx::PxErrorCode::Enum, const char*, const char*, int) override {}
};

/// Made when it is first used, and never released.
inline physx::PxFoundation& physx_foundation() {
  static PhysxMemory memory;
  static PhysxSilence silence;
  static physx::PxFoundation* const foundation =
      PxCreateFoundation(PX_PHYSICS_VERSION, memory, silence);
  if (!foundation) throw std::runtime_error("PhysX: no foundation");
  return *foundation;
}

}  // namespace bvlab
