# THE lists (volumes.hpp, strategies.hpp, queries.hpp, broadphase.hpp) as CMake sees them, so that each
# entry can be compiled by itself. The units are to be named before anything is compiled, and a compiler
# says neither which header defines a type nor, where it compiles for another machine, anything at all
# while CMake runs. So C++ is read by regular expressions, all of them here, and lists_as_read.cpp.in has the
# compiler hold what was read against the lists.
set(BVLAB_LIST_INCLUDES "")
set(BVLAB_LIST_CHECKS "")

# bvlab_list(<out> <list header> <alias> <folder of the entries>): reads `using <alias> = TypeList<...>;`
# and sets <out> to "type|id|header" for each type: its file name in units, and the header that
# defines it.
function(bvlab_list out list alias folder)
  set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
               ${PROJECT_SOURCE_DIR}/${list})
  file(READ ${PROJECT_SOURCE_DIR}/${list} text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  if(NOT text MATCHES "using ${alias}[ \n]*=[ \n]*TypeList<([^;]*)>;")
    message(FATAL_ERROR "${list}: no 'using ${alias} = TypeList<...>;'")
  endif()
  string(REGEX REPLACE "[ \n]+" "" types "${CMAKE_MATCH_1}")
  set(instance ${alias})
  string(REPLACE "<T,Contact>" "<float, Closed>" instances "${types}")
  if(NOT instances STREQUAL types)
    string(APPEND instance "<float, Closed>")
  endif()
  set(BVLAB_LIST_INCLUDES "${BVLAB_LIST_INCLUDES}#include \"${list}\"\n" PARENT_SCOPE)
  set(BVLAB_LIST_CHECKS "${BVLAB_LIST_CHECKS}static_assert(std::is_same_v<${instance}, TypeList<${instances}>>);\n" PARENT_SCOPE)
  # Of templates over the list's own parameters the name alone.
  string(REPLACE "<T,Contact>" "" types "${types}")
  string(REPLACE "," ";" types "${types}")
  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/${folder}/*.hpp)
  set(entries "")
  foreach(type ${types})
    string(REGEX REPLACE "<.*" "" name "${type}")
    set(found "")
    foreach(header ${headers})
      file(STRINGS ${PROJECT_SOURCE_DIR}/${header} lines REGEX "^(struct|class|using) ${name}( |;|$)")
      if(lines)
        set(found ${header})
      endif()
    endforeach()
    if(NOT found)
      message(FATAL_ERROR "${list}: no header in ${folder} defines ${name}")
    endif()
    bvlab_entry(entry ${type} ${found})
    list(APPEND entries ${entry})
  endforeach()
  set(${out} ${entries} PARENT_SCOPE)
endfunction()

# bvlab_outside(<out type> <out header> <"header.hpp:Type">): the header's place is relative to the project, or absolute.
function(bvlab_outside type header given)
  if(NOT given MATCHES "^(.+):([A-Za-z_][A-Za-z0-9_:]*(<.*>)?)$")
    message(FATAL_ERROR "'${given}' is not header.hpp:Type")
  endif()
  set(${type} "${CMAKE_MATCH_2}" PARENT_SCOPE)
  get_filename_component(place "${CMAKE_MATCH_1}" ABSOLUTE BASE_DIR ${PROJECT_SOURCE_DIR})
  if(NOT EXISTS "${place}")
    message(FATAL_ERROR "${given}: there is no ${place}")
  endif()
  set(${header} "${place}" PARENT_SCOPE)
endfunction()

# "type|id|header" of one type.
function(bvlab_entry out type header)
  string(REGEX REPLACE "<.*" "" id "${type}")
  string(REGEX REPLACE "([a-z0-9])([A-Z])" "\\1_\\2" id "${id}")
  string(TOLOWER "${id}" id)
  # Over float is the rule; the same over double is another entry.
  if(type MATCHES "<double>")
    string(APPEND id "_double")
  endif()
  set(${out} "${type}|${id}|${header}" PARENT_SCOPE)
endfunction()

# bvlab_configured(<list variable> <only> <extra> <what>): keeps of the entries those whose id or type
# is in <only> (all where that is empty), and adds those of <extra>, "header.hpp:Type" each.
function(bvlab_configured variable only extra what)
  set(kept "")
  set(unknown ${only})
  foreach(entry ${${variable}})
    string(REPLACE "|" ";" parts "${entry}")
    list(GET parts 1 id)
    string(REPLACE "_" "-" name "${id}")
    if(NOT only OR id IN_LIST only OR name IN_LIST only)
      list(APPEND kept "${entry}")
      list(REMOVE_ITEM unknown ${id} ${name})
    endif()
  endforeach()
  if(unknown)
    message(FATAL_ERROR "no ${what} '${unknown}' in the list")
  endif()
  foreach(each ${extra})
    bvlab_outside(type header "${each}")
    bvlab_entry(entry "${type}" "${header}")
    list(APPEND kept "${entry}")
  endforeach()
  set(${variable} ${kept} PARENT_SCOPE)
endfunction()

# Sets <kind>, <kind>_id and <kind>_header from "type|id|header".
macro(bvlab_split kind entry)
  string(REPLACE "|" ";" bvlab_parts "${entry}")
  list(GET bvlab_parts 0 ${kind})
  list(GET bvlab_parts 1 ${kind}_id)
  list(GET bvlab_parts 2 ${kind}_header)
endmacro()
