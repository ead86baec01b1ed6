// SPDX-License-Identifier: GPL-2.0-or-later
// What a dispatcher calls for a class, or a pair of classes.
#pragma once

#include <core/Timing.hpp>
#include <lib/multimethods/FunctorWrapper.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Scene;

class Functor : public Serializable {
public:
    shared_ptr<TimingDeltas> timingDeltas;
    Scene* scene; // set by the dispatcher before each loop
    string label;

    Functor() noexcept : scene(nullptr) {}
    virtual vector<std::string> getFunctorTypes() const;
    ANCF_PACKAGED(Functor)
};

// Between Functor and the abstract functors; the libraries hold their functions.
template <class Type1, class Result, class Args> class Functor1D : public Functor, public FunctorWrapper<Result, Args> {
public:
    using DispatchType1 = Type1;
    using ReturnType = Result;
    using ArgumentTypes = Args;

    Functor1D() noexcept {}
    ~Functor1D() override;
    std::string getBaseClassName(unsigned which = 0) const override;
    int getBaseClassNumber() const override;
    std::string getClassName() const override;
    vector<std::string> getFunctorTypes() const override;
    virtual std::string get1DFunctorType1() const;
};

template <class Type1, class Type2, class Result, class Args> class Functor2D : public Functor,
                                                                                public FunctorWrapper<Result, Args> {
public:
    using DispatchType1 = Type1;
    using DispatchType2 = Type2;
    using ReturnType = Result;
    using ArgumentTypes = Args;

    Functor2D() noexcept {}
    ~Functor2D() override;
    std::string getBaseClassName(unsigned which = 0) const override;
    int getBaseClassNumber() const override;
    std::string getClassName() const override;
    vector<std::string> getFunctorTypes() const override;
    virtual std::string get2DFunctorType1() const;
    virtual std::string get2DFunctorType2() const;
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Functor)

#define FUNCTOR1D(type1)                                                                                               \
public:                                                                                                                \
    std::string get1DFunctorType1() const override { return #type1; }

#define FUNCTOR2D(type1, type2)                                                                                        \
public:                                                                                                                \
    std::string get2DFunctorType1() const override { return #type1; }                                                  \
    std::string get2DFunctorType2() const override { return #type2; }
