// Part of programs under a sanitizer: libraries stay loaded until the end, so that what they leave can be told by
// their names (lsan.supp).

extern "C" int dlclose(void* /*library*/) {
    return 0;
}
