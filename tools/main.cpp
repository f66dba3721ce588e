#include "tools/run.h"

int main(int argc, char** argv) { return panwright::tools::run(argc, argv); }
