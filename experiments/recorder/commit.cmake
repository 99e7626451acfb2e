# Run at every build: which commit the program is built from, and whether what it is built from has changed since.
# What is written and drawn about records (pages, plots, the paper, tests, records themselves) changes no measurement.
# Code that the commit does not have, from outside the tree or not tracked, is named with its hash, and is a change.
# cmake -DSOURCE=... -DHEADER=... [-DGIT=...] [-DOUTSIDE=a.hpp,b.hpp] -P commit.cmake
set(commit "")
set(changes unknown)
if(GIT AND EXISTS ${SOURCE}/.git)
  # Whoever owns the folder: in a container git would refuse it.
  set(git ${GIT} -c safe.directory=* -C ${SOURCE})
  execute_process(COMMAND ${git} rev-parse HEAD OUTPUT_VARIABLE commit ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  execute_process(COMMAND ${git} status --porcelain --untracked-files=no -- . :!experiments/record :!plots :!paper
                          :!tests :!.ci :!*.md
                  OUTPUT_VARIABLE changed ERROR_QUIET RESULT_VARIABLE fault)
  if(commit AND fault EQUAL 0)
    set(changes no)
    if(changed)
      set(changes yes)
    endif()
  endif()
elseif(EXISTS ${SOURCE}/.git/HEAD)
  # No git to ask: the branch's file, where there is one, holds the commit.
  file(READ ${SOURCE}/.git/HEAD commit)
  string(STRIP "${commit}" commit)
  if(commit MATCHES "^ref: (.*)")
    set(commit "")
    if(EXISTS ${SOURCE}/.git/${CMAKE_MATCH_1})
      file(READ ${SOURCE}/.git/${CMAKE_MATCH_1} commit)
      string(STRIP "${commit}" commit)
    endif()
  endif()
endif()
set(outside "")
string(REPLACE "," ";" files "${OUTSIDE}")
foreach(file ${files})
  if(commit AND GIT)
    execute_process(COMMAND ${git} ls-files --error-unmatch -- ${file} OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE untracked)
    if(untracked EQUAL 0)
      continue()
    endif()
  endif()
  file(SHA256 "${file}" hash)
  string(APPEND outside "\n    {R\"(${file})\", \"${hash}\"},")
  set(changes yes)
endforeach()
file(CONFIGURE OUTPUT ${HEADER} @ONLY CONTENT [[
// SPDX-License-Identifier: BSD-3-Clause
/// Generated: the commit that the program was built from, "" where it is unknown.
#pragma once

namespace bvlab::build_facts {

inline constexpr char commit[] = "@commit@";
inline constexpr char changes[] = "@changes@";  // "yes", "no" or "unknown"

/// Files from outside the tree that volumes or strategies come from, and an end.
struct Outside {
  const char *path, *sha256;
};
inline constexpr Outside outside[] = {@outside@
    {"", ""}};

}  // namespace bvlab::build_facts
]])
