# SPDX-License-Identifier: Apache-2.0
# Warnings and language level of every target of the project; never exported.
add_library(geocloth_options INTERFACE)
target_compile_features(geocloth_options INTERFACE cxx_std_20)
target_compile_options(geocloth_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wnon-virtual-dtor -Wold-style-cast
  # Contracting a*b+c into one rounding would part the backends from each other.
  -ffp-contract=off)

# geocloth_add_library(NAME component) defines the static library geocloth_<component>, its alias
# geocloth::<component>, and its install with one export file per component.
# Public headers lie in <folder>/include, sources are given with target_sources.
function(geocloth_add_library component)
  set(target geocloth_${component})
  add_library(${target} STATIC)
  add_library(geocloth::${component} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${component} POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:geocloth_options>)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/include/*.h)
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR}/include FILES ${headers})
  install(TARGETS ${target} EXPORT geocloth-${component}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component}
          FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${component})
  install(EXPORT geocloth-${component} NAMESPACE geocloth:: FILE geocloth-${component}-targets.cmake
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/geocloth COMPONENT ${component})
endfunction()

# geocloth_unite_folders(target): with GEOCLOTH_UNITE_FOLDERS the sources of one folder are compiled as one text, so no
# two of them define one name. What lists instruction sets by including itself stays by itself.
function(geocloth_unite_folders target)
  if(NOT GEOCLOTH_UNITE_FOLDERS)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # The text is a header to GCC there.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source NORMALIZE)
    file(STRINGS ${source} by_target REGEX "HWY_TARGET_INCLUDE")
    if(by_target)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    else()
      cmake_path(GET source PARENT_PATH folder)
      cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
      string(MAKE_C_IDENTIFIER ${folder} folder)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder})
    endif()
  endforeach()
endfunction()
