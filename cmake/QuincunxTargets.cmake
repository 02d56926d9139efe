# How every target of the tree is made: one function a kind, so that flags are written once.

include_guard()

# Flags that all of our own code is compiled with.
add_library(quincunx_flags INTERFACE)
target_compile_features(quincunx_flags INTERFACE cxx_std_20)
# Numbers must not depend on what the optimizer finds: g++ 12 deletes double(float(x)) roundings when it
# vectorises neighbouring statements, and contracts a*b + c into one rounding where the machine has fma.
target_compile_options(quincunx_flags INTERFACE
  $<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wno-sign-conversion;-Werror>
  -ffp-contract=off
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-tree-slp-vectorize>)
if(QUINCUNX_SANITIZE)
  # g++ 12 takes what the sanitizers add to the standard library for reads of uninitialised values.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
                      -Wno-maybe-uninitialized)
  add_link_options(-fsanitize=address,undefined)
  target_sources(quincunx_flags INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/cmake/keep_libraries.cpp>)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

# `./quincunx` builds with CMAKE_UNITY_BUILD: the sources of a target are compiled several at a time, which takes
# half as long, since what they include is read and instantiated once. So names in the unnamed namespaces of a
# folder differ; what is listed as APART is compiled by itself, because it shares some. By hand and in the other
# presets every file is compiled alone, where a missing include shows.
set(CMAKE_UNITY_BUILD_BATCH_SIZE 6)
function(quincunx_compile_apart)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# quincunx_module(<name> [SOURCES ...] [APART <sources>...] [PUBLIC <targets>...] [PRIVATE <targets>...])
# A room of common/: the static library quincunx_<name>, from all .cpp files of the folder it is called in.
function(quincunx_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;APART;PUBLIC;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS "*.cpp")
  file(GLOB headers CONFIGURE_DEPENDS "*.h")
  list(APPEND sources ${ARG_SOURCES})
  if(sources)
    add_library(quincunx_${name} STATIC ${sources})
    target_link_libraries(quincunx_${name} PUBLIC quincunx_flags ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
    quincunx_compile_apart(${ARG_APART})
    target_include_directories(quincunx_${name} PUBLIC
      $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/common> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/quincunx>)
  else()
    add_library(quincunx_${name} INTERFACE)
    target_link_libraries(quincunx_${name} INTERFACE quincunx_flags ${ARG_PUBLIC})
    target_include_directories(quincunx_${name} INTERFACE
      $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/common> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/quincunx>)
  endif()
  set_property(GLOBAL APPEND PROPERTY QUINCUNX_MODULES quincunx_${name})
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/quincunx/${name})
endfunction()

# Tests are compiled more often than they run long: what they call is optimised, they themselves little.
add_library(quincunx_test_flags INTERFACE)
target_compile_options(quincunx_test_flags INTERFACE $<$<CONFIG:Release>:-O1>)

# quincunx_test(<name> SOURCES ... [APART <sources>...] [LIBRARIES ...] [TIMEOUT seconds] [TOGETHER])
# A GoogleTest program; each TEST becomes a CTest test of its own, in a process of its own. TOGETHER: all are one,
# for programs whose start takes longer than their tests; its output names the TEST that failed.
function(quincunx_test name)
  cmake_parse_arguments(ARG "TOGETHER" "TIMEOUT" "SOURCES;APART;LIBRARIES" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(QUINCUNX_SANITIZE)
    math(EXPR ARG_TIMEOUT "10 * ${ARG_TIMEOUT}")
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} quincunx_test_support quincunx_test_flags GTest::gmock)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  quincunx_compile_apart(${ARG_APART})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
  # LeakSanitizer of g++ 12 may crash on the thread-local storage of libraries that were just loaded.
  set(properties TIMEOUT ${ARG_TIMEOUT}
      ENVIRONMENT "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/cmake/lsan.supp:print_suppressions=0:intercept_tls_get_addr=0")
  if(ARG_TOGETHER)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES ${properties})
  else()
    gtest_discover_tests(${name} TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60 PROPERTIES ${properties})
  endif()
endfunction()
