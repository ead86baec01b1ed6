// SPDX-License-Identifier: GPL-2.0-or-later
// Elastic material, without and with friction.
#pragma once

#include <core/Material.hpp>

namespace yade {

class ElastMat : public Material {
public:
    Real young;
    Real poisson;

    ElastMat() : young(1e9), poisson(.25) { createIndex(); }
    ANCF_PACKAGED(ElastMat)
    ANCF_PACKAGED_INDEX
};

class FrictMat : public ElastMat {
public:
    Real frictionAngle; // [rad]

    FrictMat();
    ANCF_PACKAGED(FrictMat)
    ANCF_PACKAGED_INDEX
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(ElastMat)
ANCF_PACKAGED_REGISTERED(FrictMat)
