# SPDX-License-Identifier: GPL-3.0-or-later
set(root ${BUILD}/tests/install/root)
set(work ${BUILD}/tests/install)
file(REMOVE_RECURSE ${root} ${work}/parametrize ${work}/solver)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}: ${status}\n${output}")
  endif()
  message(STATUS "${output}")
endfunction()

function(build_consumer name)
  run(${CMAKE_COMMAND} -S ${SOURCE}/tests/install/${name} -B ${work}/${name} -G ${GENERATOR}
      -D CMAKE_PREFIX_PATH=${root} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_FLAGS=${FLAGS}
      -D CMAKE_BUILD_TYPE=${TYPE} ${ARGN})
  run(${CMAKE_COMMAND} --build ${work}/${name})
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${root})
build_consumer(parametrize -D CMAKE_DISABLE_FIND_PACKAGE_Vulkan=ON)
run(${work}/parametrize/convert_mesh ${SOURCE}/meshes/garments/sleeve.obj ${work}/sleeve.glb)
# Whoever ships only the solver needs neither CGAL nor assimp nor a Vulkan SDK.
set(without "")
foreach(package CGAL assimp Eigen3 Vulkan nlohmann_json CLI11 PNG JPEG OpenEXR)
  list(APPEND without -D CMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
build_consumer(solver ${without})
run(${work}/solver/drop_shirt ${work}/sleeve.glb)
