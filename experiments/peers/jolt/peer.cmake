# Of no distribution: where CMAKE_PREFIX_PATH names an installation, which must have been built with run-time type
# information (-DCPP_RTTI_ENABLED=ON): the adapter has a shape of its own.
bvlab_optional(JOLT FIND Jolt)
if(BVLAB_JOLT)
  # These give its classes other members than the adapter's.
  get_target_property(definitions Jolt::Jolt INTERFACE_COMPILE_DEFINITIONS)
  if(definitions MATCHES "JPH_DEBUG_RENDERER|JPH_PROFILE_ENABLED")
    message(FATAL_ERROR "Jolt: was built with its debug renderer or its profiler; experiments/peers/jolt/README.md has the options")
  endif()
  # Its package names no version; its header does.
  get_target_property(include Jolt::Jolt INTERFACE_INCLUDE_DIRECTORIES)
  list(GET include 0 include)
  file(STRINGS ${include}/Jolt/Core/Core.h version REGEX "define JPH_VERSION_(MAJOR|MINOR|PATCH) ")
  string(REGEX REPLACE "[^0-9;]*([0-9]+)[^;]*" "\\1" version "${version}")
  string(JOIN "." version ${version})
  string(REGEX REPLACE "JOLT $" "Jolt ${version}" BVLAB_LIBRARIES "${BVLAB_LIBRARIES}")
endif()
bvlab_peer(FOUND ${BVLAB_JOLT} LINK Jolt::Jolt BOXES boxes.cpp)
