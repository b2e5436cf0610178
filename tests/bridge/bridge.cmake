# The bridges as the clients of others hear them; their packages are common to all builds. Without npm's packages it is skipped, and says so.
if(TARGET tactum AND NOT TACTUM_SANITIZE)
  find_program(NODE NAMES node nodejs)
  add_test(NAME bridge.clients COMMAND ${NODE} ${CMAKE_CURRENT_SOURCE_DIR}/bridge/clients.mjs $<TARGET_FILE:tactum>
            ${PROJECT_SOURCE_DIR}/build/bridge-clients)
  set_tests_properties(bridge.clients PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 240)
endif()
