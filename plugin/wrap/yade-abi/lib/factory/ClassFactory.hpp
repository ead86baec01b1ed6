// SPDX-License-Identifier: GPL-2.0-or-later
// Makes objects by class name.
#pragma once

#include <lib/base/Math.hpp>
#include <lib/base/Singleton.hpp>

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/xml_iarchive.hpp>
#include <boost/archive/xml_oarchive.hpp>

#include <boost/serialization/export.hpp> // after all archives, so that each gets every exported class

#include <boost/serialization/list.hpp>
#include <boost/serialization/map.hpp>
#include <boost/serialization/shared_ptr.hpp>
#include <boost/serialization/vector.hpp>

namespace yade {

class Factorable;

class ClassFactory : public Singleton<ClassFactory> {
public:
    using CreateRaw = Factorable* (*)();
    using CreateShared = shared_ptr<Factorable> (*)();
    using CreateCustom = void* (*)();

    shared_ptr<Factorable> createShared(std::string name);
    bool registerFactorable(std::string name, CreateRaw, CreateShared, CreateCustom);
};

// A class of this plugin, waiting until the layout check has passed: then module.cpp hands it to ClassFactory.
struct PendingClass {
    const char* name;
    ClassFactory::CreateRaw createRaw;
    ClassFactory::CreateShared createShared;
    ClassFactory::CreateCustom createCustom;
};
std::vector<PendingClass>& pendingClasses();

template <class T> Factorable* createRaw() { return new T; }
template <class T> shared_ptr<Factorable> createShared() { return shared_ptr<T>(new T); }
template <class T> void* createCustom() { return new T; }

} // namespace yade

#define ANCF_PENDING_CLASS(r, data, klass)                                                                             \
    ::yade::pendingClasses().push_back({BOOST_PP_STRINGIZE(klass), ::yade::createRaw<::yade::klass>,                   \
                                                           ::yade::createShared<::yade::klass>,                        \
                                                           ::yade::createCustom<::yade::klass>});

#define ANCF_EXPORT_CLASS(r, data, klass)                                                                              \
    BOOST_CLASS_EXPORT_IMPLEMENT(yade::klass)                                                                          \
    BOOST_SERIALIZATION_FACTORY_0(yade::klass)

// In the .cpp of a class, inside namespace yade: YADE_PLUGIN((ClassA)(ClassB))
#define YADE_PLUGIN(classes)                                                                                           \
    }                                                                                                                  \
    namespace {                                                                                                        \
        __attribute__((constructor)) void BOOST_PP_CAT(announce_, BOOST_PP_SEQ_HEAD(classes))() {                      \
            BOOST_PP_SEQ_FOR_EACH(ANCF_PENDING_CLASS, ~, classes)                                                      \
        }                                                                                                              \
    }                                                                                                                  \
    BOOST_PP_SEQ_FOR_EACH(ANCF_EXPORT_CLASS, ~, classes)                                                               \
    namespace yade {
