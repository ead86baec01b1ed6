// SPDX-License-Identifier: GPL-2.0-or-later
// Classes that dispatchers tell apart by a number.
#pragma once

#include <stdexcept>

namespace yade {

class Indexable {
    [[noreturn]] static int& noIndex() { throw std::logic_error("class without REGISTER_CLASS_INDEX"); }

protected:
    virtual void incrementMaxCurrentlyUsedClassIndexOfKin() { noIndex(); }
    virtual int& modifyClassIndex() { noIndex(); }

    // In the constructor of every indexed class; a class gets its number when its first object is made.
    void createIndex() {
        int& index = modifyClassIndex();
        if (index != -1) return;
        index = getMaxCurrentlyUsedClassIndexOfKin() + 1;
        incrementMaxCurrentlyUsedClassIndexOfKin();
    }

public:
    Indexable() noexcept {}
    virtual ~Indexable() = default;
    virtual const int& getClassIndex() const { noIndex(); }
    virtual const int& getBaseClassIndex(int) const { noIndex(); }
    virtual const int& getMaxCurrentlyUsedClassIndexOfKin() const { noIndex(); }
};

} // namespace yade

#define REGISTER_CLASS_INDEX(klass, base)                                                                              \
private:                                                                                                               \
    static int& modifyClassIndexStatic() {                                                                             \
        static int number = -1;                                                                                        \
        return number;                                                                                                 \
    }                                                                                                                  \
                                                                                                                       \
protected:                                                                                                             \
    int& modifyClassIndex() override { return modifyClassIndexStatic(); }                                              \
                                                                                                                       \
public:                                                                                                                \
    static const int& getClassIndexStatic() { return modifyClassIndexStatic(); }                                       \
    const int& getClassIndex() const override { return getClassIndexStatic(); }                                        \
    const int& getBaseClassIndex(int depth) const override {                                                           \
        return depth == 1 ? base::getClassIndex() : base::getBaseClassIndex(depth - 1);                                \
    }

// The index functions of a packaged class, all defined in the libraries.
#define ANCF_PACKAGED_INDEX                                                                                            \
protected:                                                                                                             \
    int& modifyClassIndex() override;                                                                                  \
                                                                                                                       \
public:                                                                                                                \
    const int& getClassIndex() const override;                                                                         \
    const int& getBaseClassIndex(int depth) const override;

// The order of declaration is that of the vtable.
#define ANCF_PACKAGED_INDEX_ROOT                                                                                       \
    ANCF_PACKAGED_INDEX                                                                                                \
    const int& getMaxCurrentlyUsedClassIndexOfKin() const override;                                                    \
                                                                                                                       \
protected:                                                                                                             \
    void incrementMaxCurrentlyUsedClassIndexOfKin() override;                                                          \
                                                                                                                       \
public:
