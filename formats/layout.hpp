#pragma once

// The bytes of a model file: what every file has, and the sections of every problem.

#include "formats/layout/elastostatic.hpp"
#include "formats/layout/header.hpp"
#include "formats/layout/impulse_response.hpp"
#include "formats/layout/multigrid.hpp"
#include "formats/layout/section_kinds.hpp"
