// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Shape.hpp>

namespace yade {

class Wall : public Shape {
public:
    int sense; // -1, 0, 1: side that acts
    int axis;

    Wall() : sense(0), axis(0) { createIndex(); }
    ANCF_PACKAGED(Wall)
    ANCF_PACKAGED_INDEX
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Wall)
