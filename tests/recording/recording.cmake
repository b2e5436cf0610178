# Recordings as other programs read them. Without the reader's package, which comes with those of the page, it is skipped.
if(TARGET tactum AND NOT TACTUM_SANITIZE)
  find_program(NODE NAMES node nodejs)
  add_test(NAME recording.mcap_core
    COMMAND ${NODE} ${CMAKE_CURRENT_SOURCE_DIR}/recording/mcap_core.mjs $<TARGET_FILE:tactum>)
  set_tests_properties(recording.mcap_core PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 240)
  add_test(NAME recording.exports
    COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/recording/exports.py $<TARGET_FILE:tactum>)
  set_tests_properties(recording.exports PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 240)
  add_test(NAME recording.dataset
    COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/recording/dataset.py $<TARGET_FILE:tactum>
            ${PROJECT_SOURCE_DIR}/examples/learning/recordings_to_dataset.py)
  set_tests_properties(recording.dataset PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 240)
  # What it costs the loop.
  add_test(NAME recording.work_per_frame
    COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/recording/work_per_frame.py $<TARGET_FILE:tactum>)
  set_tests_properties(recording.work_per_frame PROPERTIES LABELS slow SKIP_RETURN_CODE 77 TIMEOUT 600)
  add_test(NAME recording.octave
    COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/recording/octave.py $<TARGET_FILE:tactum>)
  set_tests_properties(recording.octave PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 240)
endif()
