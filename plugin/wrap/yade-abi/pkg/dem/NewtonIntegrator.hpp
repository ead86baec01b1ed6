// SPDX-License-Identifier: GPL-2.0-or-later
// Moves the bodies.
#pragma once

#include <core/Interaction.hpp>
#include <pkg/common/FieldApplier.hpp>

namespace yade {

class NewtonIntegrator : public FieldApplier {
    bool syncEnsured;
    bool cellChanged;
    int homoDeform;
    bool bodySelected;
    Matrix3r dVelGrad;
    Vector3r dSpin;

public:
    bool densityScaling;
    Real updatingDispFactor;
    vector<Real> threadMaxVelocitySq;
    Real damping;
    Vector3r gravity;
    Real maxVelocitySq; // or a flag for the collider: 2 sort now, 0.5 not needed, 0 nothing watched
    bool exactAsphericalRot;
#if ANCF_YADE_VERSION >= 202502
    int rotAlgorithm; // an enumeration there, of this size
    int normalizeEvery;
    int niterOmelyan1998;
#endif
    Matrix3r prevVelGrad;
    Vector3r prevCellSize;
    bool warnNoForceReset;
    int nonviscDampIx;
    bool kinSplit;
    bool dampGravity;
    int kinEnergyIx;
    int kinEnergyTransIx;
    int kinEnergyRotIx;
    int mask;

    NewtonIntegrator();
    void saveMaximaDisplacement(const shared_ptr<Body>&);
    void action() override;
    ANCF_PACKAGED(NewtonIntegrator)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(NewtonIntegrator)
