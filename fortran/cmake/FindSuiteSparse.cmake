# Imported targets SuiteSparse::<COMPONENT>. SuiteSparse 7 brings CMake packages, which are used when
# present; version 5 has none, so headers and libraries are looked for. Hint: SuiteSparse_ROOT.
include(FindPackageHandleStandardArgs)
set(_header_CHOLMOD cholmod.h)
set(_header_UMFPACK umfpack.h)

find_path(SuiteSparse_INCLUDE_DIR SuiteSparse_config.h PATH_SUFFIXES suitesparse)
mark_as_advanced(SuiteSparse_INCLUDE_DIR)
if(SuiteSparse_INCLUDE_DIR)
  file(STRINGS "${SuiteSparse_INCLUDE_DIR}/SuiteSparse_config.h" _lines
       REGEX "#define +SUITESPARSE_(MAIN|SUB|SUBSUB)_VERSION +[0-9]+")
  foreach(_part MAIN SUB SUBSUB)
    set(_${_part} 0)
    foreach(_line IN LISTS _lines)
      if(_line MATCHES "SUITESPARSE_${_part}_VERSION +([0-9]+)")
        set(_${_part} ${CMAKE_MATCH_1})
      endif()
    endforeach()
  endforeach()
  set(SuiteSparse_VERSION "${_MAIN}.${_SUB}.${_SUBSUB}")
endif()

foreach(_component IN LISTS SuiteSparse_FIND_COMPONENTS)
  string(TOLOWER ${_component} _lower)
  if(NOT TARGET SuiteSparse::${_component})
    find_package(${_component} QUIET CONFIG)
  endif()
  if(NOT TARGET SuiteSparse::${_component})
    find_library(SuiteSparse_${_component}_LIBRARY ${_lower})
    mark_as_advanced(SuiteSparse_${_component}_LIBRARY)
    if(SuiteSparse_${_component}_LIBRARY AND EXISTS "${SuiteSparse_INCLUDE_DIR}/${_header_${_component}}")
      add_library(SuiteSparse::${_component} UNKNOWN IMPORTED)
      set_target_properties(SuiteSparse::${_component} PROPERTIES
        IMPORTED_LOCATION "${SuiteSparse_${_component}_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${SuiteSparse_INCLUDE_DIR}")
    endif()
  endif()
  if(TARGET SuiteSparse::${_component})
    set(SuiteSparse_${_component}_FOUND TRUE)
  endif()
endforeach()
find_package_handle_standard_args(SuiteSparse REQUIRED_VARS SuiteSparse_INCLUDE_DIR
  VERSION_VAR SuiteSparse_VERSION HANDLE_COMPONENTS)
