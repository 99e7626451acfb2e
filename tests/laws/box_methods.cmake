# The laws of broad-phase methods: one program for each scalar and each meaning of touching. Lightly
# optimised, since there is much to compile and little to wait for.
foreach(scalar float double)
  foreach(contact Closed HalfOpen)
    string(TOLOWER box_methods_${scalar}_${contact} name)
    bvlab_test(${name} SOURCES ${CMAKE_CURRENT_LIST_DIR}/box_methods_test.cpp)
    target_compile_definitions(test_${name} PRIVATE BVLAB_TEST_SCALAR=${scalar} BVLAB_TEST_CONTACT=${contact})
    target_compile_options(test_${name} PRIVATE -O1)
  endforeach()
endforeach()
bvlab_test(box_structures SOURCES ${CMAKE_CURRENT_LIST_DIR}/box_structures_test.cpp)
bvlab_test(box_allocations SOURCES ${CMAKE_CURRENT_LIST_DIR}/box_allocations_test.cpp)
target_compile_options(test_box_allocations PRIVATE -O1)
