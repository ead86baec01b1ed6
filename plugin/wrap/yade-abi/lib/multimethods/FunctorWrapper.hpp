// SPDX-License-Identifier: GPL-2.0-or-later
// What a dispatcher calls: go() with one to seven arguments. Those not overridden throw, inside the libraries.
#pragma once

#include <lib/compatibility/LokiCompatibility.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

template <class Result, class Args> class FunctorWrapper {
    template <int i> using Arg = typename boost::mpl::at_c<Args, i>::type;
    using A0 = Arg<0>;
    using A1 = Arg<1>;
    using A2 = Arg<2>;
    using A3 = Arg<3>;
    using A4 = Arg<4>;
    using A5 = Arg<5>;
    using A6 = Arg<6>;

public:
    FunctorWrapper() noexcept {}
    virtual ~FunctorWrapper() {} // not exported by the libraries; needed without optimization
    virtual std::string checkOrder() const;

    virtual Result go(A0);
    virtual Result go(A0, A1);
    virtual Result go(A0, A1, A2);
    virtual Result go(A0, A1, A2, A3);
    virtual Result go(A0, A1, A2, A3, A4);
    virtual Result go(A0, A1, A2, A3, A4, A5);
    virtual Result go(A0, A1, A2, A3, A4, A5, A6);

    virtual Result goReverse(A0);
    virtual Result goReverse(A0, A1);
    virtual Result goReverse(A0, A1, A2);
    virtual Result goReverse(A0, A1, A2, A3);
    virtual Result goReverse(A0, A1, A2, A3, A4);
    virtual Result goReverse(A0, A1, A2, A3, A4, A5);
    virtual Result goReverse(A0, A1, A2, A3, A4, A5, A6);
};

} // namespace yade

#define DEFINE_FUNCTOR_ORDER_2D(first, second)                                                                         \
public:                                                                                                                \
    std::string checkOrder() const override { return #first " " #second; }
