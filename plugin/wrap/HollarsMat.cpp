// SPDX-License-Identifier: GPL-2.0-or-later
#include "HollarsMat.hpp"

#include <lib/pyutil/gil.hpp>

#include <cmath>
#include <sstream>

namespace yade {

YADE_PLUGIN((HollarsMat))

namespace {
    void require(bool good, const char* attribute, Real value, const char* rule) {
        if (good) return;
        std::ostringstream text;
        text << "HollarsMat." << attribute << " = " << value << ": " << rule;
        throw std::invalid_argument(text.str());
    }

    void warnKineticAboveStatic(Real kinetic, Real still) {
        std::ostringstream text;
        text << "HollarsMat.kineticFriction = " << kinetic << " is above staticFriction = " << still;
        gilLock lock; // postLoad also runs while a scene is loaded
        if (PyErr_WarnEx(PyExc_UserWarning, text.str().c_str(), 1) < 0) py::throw_error_already_set();
    }
} // namespace

void HollarsMat::postLoad(HollarsMat&) {
    require(std::isfinite(young) && young > 0, "young", young, "must be positive and finite [Pa]");
    require(poisson > -1 && poisson <= .5, "poisson", poisson, "must be above -1 and at most 0.5");
    require(std::isfinite(density) && density > 0, "density", density, "must be positive and finite [kg/m^3]");
    require(std::isfinite(staticFriction) && staticFriction >= 0, "staticFriction", staticFriction,
            "must be 0 or more, and finite");
    require(std::isfinite(kineticFriction) && kineticFriction >= 0, "kineticFriction", kineticFriction,
            "must be 0 or more, and finite");
    require(std::isfinite(transitionVelocity) && transitionVelocity > 0, "transitionVelocity", transitionVelocity,
            "must be positive and finite [m/s]");
    require(std::isfinite(impactDamping) && impactDamping >= 0, "impactDamping", impactDamping,
            "must be 0 or more, and finite [s/m]");
    require(std::isfinite(dashpot) && dashpot >= 0, "dashpot", dashpot, "must be 0 or more, and finite [N s/m]");
    require(std::isnan(normalStiffness) || (std::isfinite(normalStiffness) && normalStiffness > 0), "normalStiffness",
            normalStiffness, "must be positive and finite [N/m^n], or NaN for Hertz");
    require(std::isfinite(normalExponent) && normalExponent >= 1, "normalExponent", normalExponent,
            "must be 1 or more, and finite");
    if (kineticFriction > staticFriction) warnKineticAboveStatic(kineticFriction, staticFriction);
}

void HollarsMat::takeFrictionAngle() {
    if (std::isnan(frictionAngle)) return;
    staticFriction = kineticFriction = std::tan(frictionAngle);
    frictionAngle = std::numeric_limits<Real>::quiet_NaN();
}

void HollarsMat::setChecked(Real& field, Real value) {
    const Real old = field;
    field = value;
    try {
        postLoad(*this);
    } catch (...) {
        field = old;
        throw;
    }
}

} // namespace yade
