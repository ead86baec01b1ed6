// SPDX-License-Identifier: GPL-2.0-or-later
// Engines that call functors.
#pragma once

#include <core/Engine.hpp>
#include <core/Functor.hpp>

namespace yade {

class Dispatcher : public Engine {
public:
    Dispatcher() {}
    virtual string getFunctorType() const;
    virtual int getDimension() const;
    virtual string getBaseClassType(unsigned which) const;
    ANCF_PACKAGED(Dispatcher)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Dispatcher)
