// SPDX-License-Identifier: GPL-2.0-or-later
// Contact with Hunt-Crossley normal force and Hollars friction: physics, the functors that make it, and its law.
#pragma once

#include "HollarsMat.hpp"

#include <core/Dispatching.hpp>
#include <pkg/common/NormShearPhys.hpp>
#include <pkg/dem/ScGeom.hpp>

extern "C" {
#include "ancf/law.h"
}

namespace yade {

class HollarsPhys : public NormShearPhys {
public:
    ancf_normal normalLaw() const;
    ancf_friction frictionLaw() const;
    Real damping(Real depth) const; // of the normal force against the speed of approach [N s/m]

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(HollarsPhys, NormShearPhys,
        "A contact between two bodies of which at least one is of :yref:`HollarsMat`. kn and ks are tangents [N/m]; "
        "normalForce and shearForce act on the second body [N].",
        ((Real, normalStiffness, 0, , "Stiffness $k$ of $f=k\\delta^n$ [N/m^n] (Shan, Guo and Gill 2019, Eq. 8)."))
        ((Real, normalExponent, 1.5, , "Exponent $n$ [-]."))
        ((Real, impactDamping, 0, , "$\\alpha$ of $c=\\frac32\\alpha k$ [s/m] (Eq. 10)."))
        ((Real, dashpot, 0, , "$c$ of the spring-dashpot [N s/m]."))
        ((Real, staticFriction, 0, , "$\\mu_s$ [-]."))
        ((Real, kineticFriction, 0, , "$\\mu_k$ [-]."))
        ((Real, transitionVelocity, 1e-3, , "$v_{t0}$ [m/s]."))
        ((Real, dampingForce, 0, Attr::hidden, "Damping part of a cable's normal force in the last step [N]."))
        ((int, normalKind, 2, Attr::hidden, "Which normal force the law computes."))
        ((int, frictionKind, 2, Attr::hidden, "Which friction the law computes.")),
        createIndex();
    )
    // clang-format on
    REGISTER_CLASS_INDEX(HollarsPhys, NormShearPhys)
};
REGISTER_SERIALIZABLE(HollarsPhys);

// Stiffness and exponent of a contact of that radius [m]: a material's own, the softer one if both give it, else Hertz.
void setStiffness(HollarsPhys& phys, const ElastMat& a, const ElastMat& b, Real radius);

// Laws of two materials: the smaller friction, the larger transition velocity, the mean of the damping.
void mixHollars(HollarsPhys& phys, const HollarsMat& a, const HollarsMat& b, Real radius);

class Ip2_HollarsMat_HollarsMat_HollarsPhys : public IPhysFunctor {
public:
    void go(const shared_ptr<Material>&, const shared_ptr<Material>&, const shared_ptr<Interaction>&) override;
    FUNCTOR2D(HollarsMat, HollarsMat)
    // clang-format off
    YADE_CLASS_BASE_DOC(Ip2_HollarsMat_HollarsMat_HollarsPhys, IPhysFunctor,
        "Contact of two :yref:`HollarsMat`: Hertz stiffness from both elastic constants and the radii of the shapes, "
        "a plane's being infinite (Eq. 8-9), unless a material gives normalStiffness (the smaller one if both do). "
        "$\\mu_s$ and $\\mu_k$ are the smaller, $v_{t0}$ the larger of the two, $\\alpha$ and the dashpot their mean.")
    // clang-format on
};
REGISTER_SERIALIZABLE(Ip2_HollarsMat_HollarsMat_HollarsPhys);

class Ip2_FrictMat_HollarsMat_HollarsPhys : public IPhysFunctor {
public:
    void go(const shared_ptr<Material>&, const shared_ptr<Material>&, const shared_ptr<Interaction>&) override;
    FUNCTOR2D(FrictMat, HollarsMat)
    DEFINE_FUNCTOR_ORDER_2D(FrictMat, HollarsMat)
    // clang-format off
    YADE_CLASS_BASE_DOC(Ip2_FrictMat_HollarsMat_HollarsPhys, IPhysFunctor,
        "Contact of a FrictMat with a :yref:`HollarsMat`: the former counts as "
        "$\\mu_s=\\mu_k=\\tan\\varphi$ with its elastic constants; $v_{t0}$, $\\alpha$ and the rest come from the latter.")
    // clang-format on
};
REGISTER_SERIALIZABLE(Ip2_FrictMat_HollarsMat_HollarsPhys);

class Law2_ScGeom_HollarsPhys_Hollars : public LawFunctor {
    int elasticIx = -1, dampIx = -1, frictionIx = -1;
    int normalKind = 2, frictionKind = 2;

    void trackNormal(Real elasticForce, Real force, Real rate, Real energy);

public:
    bool go(shared_ptr<IGeom>&, shared_ptr<IPhys>&, Interaction*) override;
    void postLoad(Law2_ScGeom_HollarsPhys_Hollars&);
    FUNCTOR2D(ScGeom, HollarsPhys)
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(Law2_ScGeom_HollarsPhys_Hollars, LawFunctor,
        "Normal force by Table 1 and friction by Eq. 11 of Shan, Guo and Gill (2019). Where a :yref:`CablePoint` takes "
        "part, its :yref:`CableEngine` adds damping and friction, solved at the new velocity, and passes all on; elsewhere "
        "the law solves friction with the reduced mass of the two bodies.",
        ((string, normal, "nonlinear", Attr::triggerPostLoad, "'nonlinear' (Hunt-Crossley), 'hertz' or 'linear' (spring-dashpot)."))
        ((string, friction, "hollars", Attr::triggerPostLoad, "'hollars', 'coulomb' (regularised below $v_{t0}$) or 'none'.")),
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(Law2_ScGeom_HollarsPhys_Hollars);

} // namespace yade
