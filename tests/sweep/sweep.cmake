# Sweeps, over threads and MPI, killed and resumed. Without h5py it is skipped.
if(TARGET tactum AND NOT TACTUM_SANITIZE)
  add_test(NAME sweep.same_table COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/sweep/sweep.py $<TARGET_FILE:tactum>)
  set_tests_properties(sweep.same_table PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 900 PROCESSORS 2)
endif()
