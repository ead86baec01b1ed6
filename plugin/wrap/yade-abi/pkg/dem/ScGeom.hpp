// SPDX-License-Identifier: GPL-2.0-or-later
// Contact geometry of sphere-like shapes.
#pragma once

#include <core/Interaction.hpp>
#include <core/State.hpp>
#include <pkg/dem/DemXDofGeom.hpp>

namespace yade {

class Scene;

class ScGeom : public GenericSpheresContact {
    Vector3r twist_axis;
    Vector3r orthonormal_axis;

public:
    Real& radius1; // refR1; not the radius of the shape for boxes, facets and walls
    Real& radius2;
    Real penetrationDepth;
    Vector3r shearInc;

    ScGeom();
    // Sets the normal, the increment of shear and the rotation of the contact; the old normal must still be in place.
    void precompute(const State& state1, const State& state2, const Scene*, const shared_ptr<Interaction>&,
                    const Vector3r& newNormal, bool isNew, const Vector3r& shift2, bool avoidGranularRatcheting = true);
    Vector3r& rotate(Vector3r& tangential) const;
    const Vector3r& shearIncrement() const { return shearInc; }
    Vector3r getIncidentVel(const State* state1, const State* state2, Real dt, const Vector3r& shift2,
                            const Vector3r& shiftVel, bool avoidGranularRatcheting = true) const;
    Vector3r getIncidentVel(const State* state1, const State* state2, Real dt,
                            bool avoidGranularRatcheting = true) const;
    Vector3r getRelAngVel(const State* state1, const State* state2, Real dt) const;
    ANCF_PACKAGED(ScGeom)
    ANCF_PACKAGED_INDEX
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(ScGeom)
