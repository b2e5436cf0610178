# The page in Debian's Chromium, a test a topic: tests/viewer/browser/run.mjs TOPIC. Without a page or a browser they are
# skipped, and say so.
set(topics loads drag hands glass field picking inspect friction raw energy wall stop scenes viewers stall dropped gone refusals why panel settings remarks
  keyboard spacemouse gamepad device narrow layout hover exports record replay pictures)
find_program(NODE NAMES node nodejs)
foreach(topic ${topics})
  add_test(NAME viewer.browser.${topic}
    COMMAND ${NODE} ${CMAKE_CURRENT_SOURCE_DIR}/viewer/browser/run.mjs ${topic} $<TARGET_FILE:tactum>)
  set_tests_properties(viewer.browser.${topic} PROPERTIES LABELS browser SKIP_RETURN_CODE 77 TIMEOUT 240 RUN_SERIAL ON)
endforeach()
set_tests_properties(viewer.browser.pictures PROPERTIES TIMEOUT 900)  # scenes are played up to their moment
add_test(NAME viewer.work_per_frame
  COMMAND ${PYTHON3} ${PROJECT_SOURCE_DIR}/tools/viewer_work.py $<TARGET_FILE:test_viewer>)
set_tests_properties(viewer.work_per_frame PROPERTIES LABELS slow SKIP_RETURN_CODE 77 TIMEOUT 600)
