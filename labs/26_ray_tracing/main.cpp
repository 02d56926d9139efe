#include "lab/lab.h"

QUINCUNX_LAB_MAIN
