#include "base/error.h"

int main() {
    return static_cast<int>(quincunx::InputError("no fault").exitStatus());
}
