#pragma once

#include "rt_tests/harness/elastostatic_driver.hpp"

namespace greenloop::firmware {

/// The solver of this image.
using ImageDriver = ElastostaticDriver;
using Solver = ImageDriver::Solver;

}  // namespace greenloop::firmware
