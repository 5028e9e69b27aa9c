# SPDX-License-Identifier: Apache-2.0
# geocloth_add_shaders(target source...) compiles GLSL to SPIR-V, checks it, and makes a header per shader,
# <name>_<stage>.h with `const uint32_t <name>_<stage>[]`, on the target's include path. Nothing is looked up at run time.
find_program(GEOCLOTH_SPIRV_VAL spirv-val REQUIRED)
function(geocloth_add_shaders target)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/shaders/${target})
  file(MAKE_DIRECTORY ${out})
  foreach(source IN LISTS ARGN)
    get_filename_component(name ${source} NAME)
    string(REPLACE "." "_" symbol ${name})
    get_filename_component(path ${source} ABSOLUTE)
    add_custom_command(
      OUTPUT ${out}/${symbol}.h
      COMMAND Vulkan::glslangValidator --quiet -V --target-env vulkan1.1 -I${PROJECT_SOURCE_DIR}/shaders
              -o ${out}/${symbol}.spv ${path}
      COMMAND ${GEOCLOTH_SPIRV_VAL} --target-env vulkan1.1 ${out}/${symbol}.spv
      COMMAND Vulkan::glslangValidator --quiet -V --target-env vulkan1.1 -I${PROJECT_SOURCE_DIR}/shaders
              --depfile ${out}/${symbol}.d --vn ${symbol} -o ${out}/${symbol}.h ${path}
      DEPENDS ${path} DEPFILE ${out}/${symbol}.d
      COMMENT "Shader ${name}" VERBATIM)
    target_sources(${target} PRIVATE ${out}/${symbol}.h)
  endforeach()
  target_include_directories(${target} SYSTEM PRIVATE ${out})  # system: nobody wants them checked for style
endfunction()
