#include "reference/metrics.hpp"
