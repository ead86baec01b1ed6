// SPDX-License-Identifier: GPL-2.0-or-later
// Base of all classes that are saved and seen in Python, and the macros that declare one.
#pragma once

#include <lib/base/Math.hpp>
#include <lib/factory/Factorable.hpp>

#include <boost/python/raw_function.hpp>

#include <initializer_list>

namespace yade {

namespace Attr {
    enum flags { noSave = 1, readonly = 2, triggerPostLoad = 4, hidden = 8, noResize = 16 };
}

// Hooks: a class that has a member of the same name gets its own called instead.
template <class T> void preLoad(T&) {}
template <class T> void postLoad(T&) {}
template <class T> void preSave(T&) {}
template <class T> void postSave(T&) {}

class Serializable : public Factorable {
    friend class boost::serialization::access;
    template <class Archive> void serialize(Archive&, unsigned);

public:
    Serializable() noexcept {}
    ~Serializable() override;
    std::string getBaseClassName(unsigned which = 0) const override;
    int getBaseClassNumber() const override;
    std::string getClassName() const override;

    // The order of declaration is that of the vtable.
    virtual void pySetAttr(const std::string& key, const py::object& value);
    virtual py::dict pyDict() const;
    virtual py::dict pyDictCustom() const;
    virtual void callPostLoad();
    virtual void checkPyClassRegistersItself(const std::string& thisClassName) const;
    virtual void pyRegisterClass(py::object scope);
    virtual void pyHandleCustomCtorArgs(py::tuple& positional, py::dict& keywords);

    void pyUpdateAttrs(const py::dict& attributes);
    std::string pyStr();
};

constexpr int flagsOf(std::initializer_list<int> flags) { return flags.size() ? *flags.begin() : 0; }

// ---- how an attribute is seen in Python

// Vectors come out by reference, so that b.state.vel[2] = 0 works; all else by value.
template <class T> constexpr bool seenByReference = false;
template <> inline constexpr bool seenByReference<Vector2r> = true;
template <> inline constexpr bool seenByReference<Vector3r> = true;
template <> inline constexpr bool seenByReference<Matrix3r> = true;
template <> inline constexpr bool seenByReference<Vector2i> = true;
template <> inline constexpr bool seenByReference<Vector3i> = true;
template <> inline constexpr bool seenByReference<Quaternionr> = true;

// A value given from Python. Lists are read here: YADE's converter of them never gives their items back.
template <class T> struct FromPython {
    static T read(const py::object& value) { return py::extract<T>(value)(); }
};
template <class T> struct FromPython<vector<T>> {
    static vector<T> read(const py::object& value) {
        const py::ssize_t n = py::len(value);
        vector<T> all;
        for (py::ssize_t i = 0; i < n; ++i) all.push_back(FromPython<T>::read(value[i]));
        return all;
    }
};

template <class C, class T> using Member = T C::*;

template <class C, class T> py::object attributeGetter(Member<C, T> member) {
    using ByValue = py::return_value_policy<py::return_by_value>;
    if constexpr (seenByReference<T>) return py::make_getter(member);
    else return py::make_getter(member, ByValue());
}

// A value that postLoad refuses does not stay; the object is what it was before.
template <class C, class T> py::object attributeSetter(Member<C, T> member, int flags) {
    auto set = [member, flags](C& object, const py::object& given) {
        T value = FromPython<T>::read(given), old = object.*member;
        object.*member = value;
        try {
            if (flags & Attr::triggerPostLoad) object.callPostLoad();
        } catch (...) {
            object.*member = old;
            try {
                object.callPostLoad();
            } catch (const std::exception&) { // it was refused before, too
            }
            throw;
        }
    };
    return py::make_function(set, py::default_call_policies(), boost::mpl::vector3<void, C&, const py::object&>());
}

template <class PyClass, class C, class T>
void exposeAttribute(PyClass& cls, const char* name, Member<C, T> member, int flags, const std::string& doc) {
    if (flags & Attr::hidden) return;
    const std::string fullDoc = doc + " :yattrflags:`" + std::to_string(flags) + "` ";
    if (flags & Attr::readonly) cls.add_property(name, attributeGetter(member), fullDoc.c_str());
    else cls.add_property(name, attributeGetter(member), attributeSetter(member, flags), fullDoc.c_str());
}

// X(a=1, b=2) in Python.
template <class T> shared_ptr<T> makeFromKeywords(py::tuple positional, py::dict keywords) {
    shared_ptr<T> object(new T);
    object->pyHandleCustomCtorArgs(positional, keywords);
    if (py::len(positional) > 0) throw std::runtime_error(object->getClassName() + " takes keyword arguments only");
    if (py::len(keywords) > 0) object->pyUpdateAttrs(keywords); // ends in callPostLoad
    return object;
}

template <class T> struct KeywordInit {
    py::object construct = py::make_constructor(&makeFromKeywords<T>);
    py::object operator()(py::tuple args, py::dict keywords) const {
        return construct(py::object(args[0]), py::tuple(args.slice(1, py::_)), keywords);
    }
};

template <class T, class Base> using PyClassOf = py::class_<T, shared_ptr<T>, py::bases<Base>, boost::noncopyable>;

template <class PyClass, class T> void exposeInit(PyClass& cls) {
    cls.def("__init__", py::raw_function(KeywordInit<T>(), 1));
}

inline py::docstring_options docstringOptions() { return py::docstring_options(true, true, false); }

} // namespace yade

// ---- fields of an attribute: ((type, name, initial value, flags, documentation))

#define ANCF_TYPE(a) BOOST_PP_TUPLE_ELEM(5, 0, a)
#define ANCF_NAME(a) BOOST_PP_TUPLE_ELEM(5, 1, a)
#define ANCF_INIT(a) BOOST_PP_TUPLE_ELEM(5, 2, a)
#define ANCF_FLAGS(a) (::yade::flagsOf({BOOST_PP_TUPLE_ELEM(5, 3, a)})) // may be left out
#define ANCF_DOC(a)                                                                                                    \
    BOOST_PP_TUPLE_ELEM(5, 4, a)                                                                                       \
    " :ydefault:`" BOOST_PP_STRINGIZE(ANCF_INIT(a)) "` :yattrtype:`" BOOST_PP_STRINGIZE(ANCF_TYPE(a)) "`"
#define ANCF_NAME_STR(a) BOOST_PP_STRINGIZE(ANCF_NAME(a))

#define ANCF_EACH_DECLARE(r, data, a) ANCF_TYPE(a) ANCF_NAME(a);
#define ANCF_EACH_INIT_PAIR(r, data, a) ((ANCF_NAME(a), ANCF_INIT(a)))
#define ANCF_EACH_SAVE(r, data, a)                                                                                     \
    if (!(ANCF_FLAGS(a) & ::yade::Attr::noSave)) ar& boost::serialization::make_nvp(ANCF_NAME_STR(a), ANCF_NAME(a));
#define ANCF_EACH_SET(r, data, a)                                                                                      \
    if (key == ANCF_NAME_STR(a)) {                                                                                     \
        ANCF_NAME(a) = ::yade::FromPython<decltype(ANCF_NAME(a))>::read(value);                                        \
        return;                                                                                                        \
    }
#define ANCF_EACH_DICT(r, data, a)                                                                                     \
    if (!(ANCF_FLAGS(a) & ::yade::Attr::hidden)) all[ANCF_NAME_STR(a)] = ::boost::python::object(ANCF_NAME(a));
#define ANCF_EACH_EXPOSE(r, klass, a)                                                                                  \
    ::yade::exposeAttribute(cls, ANCF_NAME_STR(a), &klass::ANCF_NAME(a), ANCF_FLAGS(a), ANCF_DOC(a));

#define ANCF_INITIALIZER(r, last, i, pair)                                                                             \
    BOOST_PP_TUPLE_ELEM(2, 0, pair)(BOOST_PP_TUPLE_ELEM(2, 1, pair)) BOOST_PP_COMMA_IF(BOOST_PP_NOT_EQUAL(last, i))
#define ANCF_INITIALIZERS(pairs)                                                                                       \
    BOOST_PP_IF(BOOST_PP_SEQ_SIZE(pairs), :, )                                                                         \
    BOOST_PP_SEQ_FOR_EACH_I(ANCF_INITIALIZER, BOOST_PP_DEC(BOOST_PP_SEQ_SIZE(pairs)), pairs)

// Saving, and the attributes as Python sees them. The order in the archive: base, then attributes as declared.
#define ANCF_ATTRIBUTE_ACCESS(klass, base, attrs)                                                                      \
    friend class boost::serialization::access;                                                                         \
                                                                                                                       \
private:                                                                                                               \
    template <class Archive> void serialize(Archive& ar, unsigned) {                                                   \
        constexpr bool loading = Archive::is_loading::value;                                                           \
        ar& boost::serialization::make_nvp(#base, boost::serialization::base_object<base>(*this));                     \
        if (loading) preLoad(*this);                                                                                   \
        else preSave(*this);                                                                                           \
        BOOST_PP_SEQ_FOR_EACH(ANCF_EACH_SAVE, ~, attrs)                                                                \
        if (loading) postLoad(*this);                                                                                  \
        else postSave(*this);                                                                                          \
    }                                                                                                                  \
                                                                                                                       \
public:                                                                                                                \
    void pySetAttr(const std::string& key, const ::boost::python::object& value) override {                            \
        BOOST_PP_SEQ_FOR_EACH(ANCF_EACH_SET, ~, attrs)                                                                 \
        base::pySetAttr(key, value);                                                                                   \
    }                                                                                                                  \
    ::boost::python::dict pyDict() const override {                                                                    \
        ::boost::python::dict all;                                                                                     \
        BOOST_PP_SEQ_FOR_EACH(ANCF_EACH_DICT, ~, attrs)                                                                \
        all.update(this->pyDictCustom());                                                                              \
        all.update(base::pyDict());                                                                                    \
        return all;                                                                                                    \
    }                                                                                                                  \
    void callPostLoad() override {                                                                                     \
        base::callPostLoad();                                                                                          \
        postLoad(*this);                                                                                               \
    }                                                                                                                  \
    REGISTER_CLASS_AND_BASE(klass, base)

#define YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(klass, base, doc, attrs, inits, ctor, pyExtras)                         \
public:                                                                                                                \
    BOOST_PP_SEQ_FOR_EACH(ANCF_EACH_DECLARE, ~, attrs)                                                                 \
    klass() ANCF_INITIALIZERS(inits BOOST_PP_SEQ_FOR_EACH(ANCF_EACH_INIT_PAIR, ~, attrs)) { ctor; }                    \
    ANCF_ATTRIBUTE_ACCESS(klass, base, attrs)                                                                          \
    void pyRegisterClass(::boost::python::object where) override {                                                     \
        checkPyClassRegistersItself(#klass);                                                                           \
        ::boost::python::scope scope(where);                                                                           \
        const auto options = ::yade::docstringOptions();                                                               \
        ::yade::PyClassOf<klass, base> cls(#klass, doc);                                                               \
        ::yade::exposeInit<decltype(cls), klass>(cls);                                                                 \
        BOOST_PP_SEQ_FOR_EACH(ANCF_EACH_EXPOSE, klass, attrs)                                                          \
        (void)cls pyExtras;                                                                                            \
    }

#define YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(klass, base, doc, attrs, ctor, pyExtras)                                     \
    YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(klass, base, doc, attrs, , ctor, pyExtras)
#define YADE_CLASS_BASE_DOC_ATTRS_CTOR(klass, base, doc, attrs, ctor)                                                  \
    YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(klass, base, doc, attrs, , ctor, )
#define YADE_CLASS_BASE_DOC_ATTRS(klass, base, doc, attrs)                                                             \
    YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(klass, base, doc, attrs, , , )
#define YADE_CLASS_BASE_DOC(klass, base, doc) YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(klass, base, doc, , , , )

// ---- static attributes (settings of Gl1 functors); their storage is defined in the .cpp

#define ANCF_EACH_STATIC_DECLARE(r, data, a) static ANCF_TYPE(a) ANCF_NAME(a);
#define ANCF_EACH_STATIC_RESET(r, klass, a) klass::ANCF_NAME(a) = ANCF_INIT(a);
#define ANCF_EACH_STATIC_EXPOSE(r, klass, a)                                                                           \
    {                                                                                                                  \
        const std::string text = std::string("|ystatic| ") + ANCF_DOC(a);                                              \
        cls.def_readwrite(ANCF_NAME_STR(a), &klass::ANCF_NAME(a), text.c_str());                                       \
    }
#define ANCF_EACH_STATIC_DOC(r, klass, a)                                                                              \
    ".. ystaticattr:: " #klass "." ANCF_NAME_STR(a) "(=" BOOST_PP_STRINGIZE(ANCF_INIT(a)) ")\n\n\t" ANCF_DOC(a) "\n\n"

#define YADE_CLASS_BASE_DOC_STATICATTRS(klass, base, doc, attrs)                                                       \
public:                                                                                                                \
    BOOST_PP_SEQ_FOR_EACH(ANCF_EACH_STATIC_DECLARE, ~, attrs)                                                          \
    ANCF_ATTRIBUTE_ACCESS(klass, base, attrs)                                                                          \
    void pyRegisterClass(::boost::python::object where) override {                                                     \
        checkPyClassRegistersItself(#klass);                                                                           \
        BOOST_PP_SEQ_FOR_EACH(ANCF_EACH_STATIC_RESET, klass, attrs)                                                    \
        ::boost::python::scope scope(where);                                                                           \
        const auto options = ::yade::docstringOptions();                                                               \
        ::yade::PyClassOf<klass, base> cls(#klass, doc);                                                               \
        ::yade::exposeInit<decltype(cls), klass>(cls);                                                                 \
        BOOST_PP_SEQ_FOR_EACH(ANCF_EACH_STATIC_EXPOSE, klass, attrs)                                                   \
    }

// ---- below a class, inside namespace yade

#define REGISTER_SERIALIZABLE(klass)                                                                                   \
    }                                                                                                                  \
    BOOST_CLASS_EXPORT_KEY(yade::klass)                                                                                \
    namespace yade {                                                                                                   \
        static_assert(true)

// ---- packaged classes: what each of them overrides, all defined in the libraries

#define ANCF_PACKAGED(klass)                                                                                           \
    friend class boost::serialization::access;                                                                         \
                                                                                                                       \
private:                                                                                                               \
    template <class Archive> void serialize(Archive&, unsigned);                                                       \
                                                                                                                       \
public:                                                                                                                \
    ~klass() override;                                                                                                 \
    std::string getBaseClassName(unsigned which = 0) const override;                                                   \
    int getBaseClassNumber() const override;                                                                           \
    std::string getClassName() const override;                                                                         \
    void pySetAttr(const std::string& key, const ::boost::python::object& value) override;                             \
    ::boost::python::dict pyDict() const override;                                                                     \
    void callPostLoad() override;                                                                                      \
    void pyRegisterClass(::boost::python::object scope) override;

#define ANCF_PACKAGED_SERIALIZER(Type)                                                                                 \
    namespace boost::archive::detail {                                                                                 \
        extern template void oserializer<xml_oarchive, Type>::save_object_data(basic_oarchive&, const void*) const;    \
        extern template void oserializer<binary_oarchive, Type>::save_object_data(basic_oarchive&, const void*) const; \
        extern template void iserializer<xml_iarchive, Type>::load_object_data(basic_iarchive&, void*,                 \
                                                                               unsigned) const;                        \
        extern template void iserializer<binary_iarchive, Type>::load_object_data(basic_iarchive&, void*,              \
                                                                                  unsigned) const;                     \
    }

// Below a packaged class, outside of any namespace: the libraries save it, load it and make it.
#define ANCF_PACKAGED_REGISTERED(klass)                                                                                \
    BOOST_CLASS_EXPORT_KEY(yade::klass)                                                                                \
    namespace boost::serialization {                                                                                   \
        template <> yade::klass* factory<yade::klass, 0>(std::va_list);                                                \
    }                                                                                                                  \
    ANCF_PACKAGED_SERIALIZER(yade::klass)

// Vectors are written by the libraries, too.
#define ANCF_PACKAGED_VECTOR(Type)                                                                                     \
    namespace boost::serialization {                                                                                   \
        template <class Archive> void serialize(Archive&, Type&, const unsigned);                                      \
    }                                                                                                                  \
    ANCF_PACKAGED_SERIALIZER(Type)

ANCF_PACKAGED_VECTOR(yade::Vector2r)
ANCF_PACKAGED_VECTOR(yade::Vector3r)
ANCF_PACKAGED_VECTOR(yade::Vector6r)
ANCF_PACKAGED_VECTOR(yade::Matrix3r)
ANCF_PACKAGED_VECTOR(yade::Vector2i)
ANCF_PACKAGED_VECTOR(yade::Vector3i)
ANCF_PACKAGED_VECTOR(yade::Quaternionr)
ANCF_PACKAGED_VECTOR(yade::Se3r)

ANCF_PACKAGED_SERIALIZER(yade::Serializable)
