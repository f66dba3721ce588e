// Transport in worlds.
#include "transport/transport.h"

#include <gtest/gtest.h>

#include "tests/transport/transport_models.h"
