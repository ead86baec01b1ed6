// SPDX-License-Identifier: GPL-2.0-or-later
// Anything that ClassFactory can make.
#pragma once

#include <lib/factory/ClassFactory.hpp>

#include <boost/enable_shared_from_this.hpp>

namespace yade {

class Factorable : public boost::enable_shared_from_this<Factorable> {
public:
    Factorable() noexcept {}
    virtual ~Factorable();
    virtual std::string getBaseClassName(unsigned which = 0) const;
    virtual int getBaseClassNumber() const;
    virtual std::string getClassName() const;
};

// The n-th word of a list of base classes separated by blanks, or "".
std::string nthWord(const char* words, unsigned n);
int countWords(const char* words);

} // namespace yade

#define REGISTER_CLASS_NAME(klass)                                                                                     \
public:                                                                                                                \
    std::string getClassName() const override { return #klass; }

#define REGISTER_BASE_CLASS_NAME(bases)                                                                                \
public:                                                                                                                \
    std::string getBaseClassName(unsigned which = 0) const override { return ::yade::nthWord(#bases, which); }         \
    int getBaseClassNumber() const override { return ::yade::countWords(#bases); }

#define REGISTER_CLASS_AND_BASE(klass, bases)                                                                          \
    REGISTER_CLASS_NAME(klass)                                                                                         \
    REGISTER_BASE_CLASS_NAME(bases)
