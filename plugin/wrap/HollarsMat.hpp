// SPDX-License-Identifier: GPL-2.0-or-later
// Material of cables and of what they touch: Hunt-Crossley normal force, Hollars friction.
#pragma once

#include <pkg/common/ElastMat.hpp>

#include <limits>

namespace yade {

class HollarsMat : public ElastMat {
    void setChecked(Real& field, Real value);

public:
    void postLoad(HollarsMat&); // throws invalid_argument (ValueError in Python) on a bad value

    // The base does not check its attributes, hence these.
    Real getYoung() const { return young; }
    Real getPoisson() const { return poisson; }
    Real getDensity() const { return density; }
    void setYoung(Real value) { setChecked(young, value); }
    void setPoisson(Real value) { setChecked(poisson, value); }
    void setDensity(Real value) { setChecked(density, value); }
    void takeFrictionAngle(); // that utils.setContactFriction has written

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(HollarsMat, ElastMat,
        "Material with Hunt-Crossley normal force $f_n=k\\delta^n(1+\\frac32\\alpha\\dot\\delta)$ and Hollars friction "
        "$f_t=f_n\\left[\\min(v_t/v_{t0},1)\\left(\\mu_k+\\frac{2(\\mu_s-\\mu_k)}{1+(v_t/v_{t0})^2}\\right)\\right]$ "
        "(Shan, Guo and Gill 2019, Eq. 10 and 11).",
        ((Real, frictionAngle, std::numeric_limits<Real>::quiet_NaN(), Attr::hidden, "Where FrictMat has its own: utils.setContactFriction writes here [rad]."))
        ((Real, staticFriction, .3, Attr::triggerPostLoad, "Coefficient of static friction $\\mu_s$ [-]."))
        ((Real, kineticFriction, .2, Attr::triggerPostLoad, "Coefficient of kinetic friction $\\mu_k$ [-]."))
        ((Real, transitionVelocity, 1e-3, Attr::triggerPostLoad,
          "Tangential velocity $v_{t0}$ at which friction is largest [m/s]."))
        ((Real, impactDamping, .2, Attr::triggerPostLoad,
          "Damping $\\alpha$ of the normal force, $c=\\frac32\\alpha k$ [s/m]: a slow impact comes back at $1-\\alpha v$ of its speed."))
        ((Real, dashpot, 0, Attr::triggerPostLoad, "Damping $c$ of the spring-dashpot law, normal='linear' [N s/m]."))
        ((Real, normalStiffness, std::numeric_limits<Real>::quiet_NaN(), Attr::triggerPostLoad,
          "Stiffness $k$ of $f=k\\delta^n$ [N/m^n]. NaN: from young, poisson and the radii of the bodies (Hertz)."))
        ((Real, normalExponent, 1.5, Attr::triggerPostLoad, "Exponent $n$ of $f=k\\delta^n$ [-].")),
        createIndex();,
        .add_property("young", &HollarsMat::getYoung, &HollarsMat::setYoung,
                      "Elastic modulus [Pa]. :ydefault:`1e9` :yattrtype:`Real`")
        .add_property("poisson", &HollarsMat::getPoisson, &HollarsMat::setPoisson,
                      "Poisson's ratio [-]. :ydefault:`.25` :yattrtype:`Real`")
        .add_property("density", &HollarsMat::getDensity, &HollarsMat::setDensity,
                      "Density [kg/m³]. :ydefault:`1000` :yattrtype:`Real`")
    )
    // clang-format on
    REGISTER_CLASS_INDEX(HollarsMat, ElastMat)
};
REGISTER_SERIALIZABLE(HollarsMat);

} // namespace yade
