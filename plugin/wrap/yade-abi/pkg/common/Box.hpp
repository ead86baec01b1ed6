// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Shape.hpp>

namespace yade {

class Box : public Shape {
public:
    Vector3r extents; // half sizes

    Box() : extents(Vector3r::Zero()) { createIndex(); }
    ANCF_PACKAGED(Box)
    ANCF_PACKAGED_INDEX
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Box)
