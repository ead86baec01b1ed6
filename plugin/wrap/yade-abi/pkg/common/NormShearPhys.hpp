// SPDX-License-Identifier: GPL-2.0-or-later
// Contacts with a normal, and a shear force.
#pragma once

#include <core/IPhys.hpp>

namespace yade {

class NormPhys : public IPhys {
public:
    Real kn;
    Vector3r normalForce;

    NormPhys();
    ANCF_PACKAGED(NormPhys)
    ANCF_PACKAGED_INDEX
};

class NormShearPhys : public NormPhys {
public:
    Real ks;
    Vector3r shearForce;

    NormShearPhys();
    ANCF_PACKAGED(NormShearPhys)
    ANCF_PACKAGED_INDEX
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(NormPhys)
ANCF_PACKAGED_REGISTERED(NormShearPhys)
