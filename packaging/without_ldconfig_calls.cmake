# Called by CPack when the packages are made. It writes scripts that call ldconfig into a package with a shared library,
# where Debian's policy wants the trigger alone, which packages.cmake gives: the scripts are taken out again.
foreach(file IN LISTS CPACK_PACKAGE_FILES)
  if(NOT file MATCHES "/libtactum-c[0-9.]+_[^/]*[.]deb$")
    continue()
  endif()
  set(unpacked ${CPACK_TEMPORARY_DIRECTORY}/unpacked)
  file(REMOVE_RECURSE ${unpacked})
  execute_process(COMMAND dpkg-deb -R ${file} ${unpacked} COMMAND_ERROR_IS_FATAL ANY)
  file(REMOVE ${unpacked}/DEBIAN/postinst ${unpacked}/DEBIAN/postrm)
  execute_process(COMMAND dpkg-deb --root-owner-group -b ${unpacked} ${file} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()
