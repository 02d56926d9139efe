# Shaders and data beside the programs, and a CMake package for those who build on the library.
install(DIRECTORY shaders data DESTINATION ${CMAKE_INSTALL_DATADIR}/quincunx)
