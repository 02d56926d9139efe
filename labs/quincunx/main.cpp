#include "labs/all_labs.h"

int main(int argc, char** argv) {
    return quincunx::runCommandLine(argc, argv, quincunx::allLabs());
}
