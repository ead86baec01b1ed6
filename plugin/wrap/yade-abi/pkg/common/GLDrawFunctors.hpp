// SPDX-License-Identifier: GPL-2.0-or-later
// Base of functors that draw a shape.
#pragma once

#include <core/Body.hpp>
#include <core/Functor.hpp>
#include <core/Shape.hpp>
#include <core/State.hpp>

namespace yade {

struct GLViewInfo {
    Vector3r sceneCenter = Vector3r::Zero();
    Real sceneRadius = 1;
};

class GlShapeFunctor
    : public Functor1D<Shape, void,
                       TYPELIST_4(const shared_ptr<Shape>&, const shared_ptr<State>&, bool, const GLViewInfo&)> {
public:
    GlShapeFunctor() noexcept {}
    // The order of declaration is that of the vtable.
    virtual string renders() const;
    virtual void initgl();
    ANCF_PACKAGED(GlShapeFunctor)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(GlShapeFunctor)

#define RENDERS(shape)                                                                                                 \
public:                                                                                                                \
    std::string renders() const override { return #shape; }                                                            \
    FUNCTOR1D(shape)
