// SPDX-License-Identifier: GPL-2.0-or-later
// Compares our declarations of YADE's classes with the YADE that is running.
#pragma once

#include <map>
#include <stdexcept>
#include <string>

namespace ancf {

struct LayoutMismatch : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Number of facts checked. overrides: our number of a fact replaced, for tests, as {"Sphere.radius": 88}.
int checkLayout(const std::map<std::string, long>& overrides);

} // namespace ancf
