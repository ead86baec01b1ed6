// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Shape.hpp>

namespace yade {

class Sphere : public Shape {
public:
    Real radius;

    Sphere();
    ANCF_PACKAGED(Sphere)
    ANCF_PACKAGED_INDEX
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Sphere)
