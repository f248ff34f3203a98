// Pointers for native functions that know which array they run through: an element outside of it ends the process.
#pragma once

extern "C" void _wp_assert(const char* expression, const char* file, unsigned line);

namespace checked {

// ends the process and names the array, the element and how many there are
inline void refuse(const char* name, long long element, long long count)
{
    char text[256]; int n = 0;
    auto word = [&](const char* s) { for (; *s && n < 200; ++s) text[n++] = *s; };
    auto number = [&](long long v) {
        char digits[24]; int m = 0;
        if (v < 0) { text[n++] = '-'; v = -v; }
        do { digits[m++] = char('0' + v % 10); v /= 10; } while (v);
        while (m) text[n++] = digits[--m];
    };
    word(name); word(": element "); number(element); word(" of "); number(count); text[n] = 0;
    _wp_assert(text, "a native function", 0);
}

template <class T> struct Pointer {
    T* at; T* first; long long count; const char* name;  // first is null for what is no array of Warp

    Pointer(T* p) : at(p), first(nullptr), count(0), name("") {}
    Pointer(T* p, T* first, long long count, const char* name) : at(p), first(first), count(count), name(name) {}

    T& operator[](long long i) const
    {
        const long long element = at + i - first;
        if (first && (element < 0 || element >= count)) refuse(name, element, count);
        return at[i];
    }
    T& operator*() const { return (*this)[0]; }
    Pointer operator+(long long i) const { return Pointer(at + i, first, count, name); }
    Pointer operator-(long long i) const { return Pointer(at - i, first, count, name); }
    operator Pointer<const T>() const { return Pointer<const T>(at, first, count, name); }
    explicit operator bool() const { return at != nullptr; }
};

template <class T> struct Bare;
template <class T> struct Bare<T*> { using Type = T; };

// `array.data`
template <class A> inline auto data(const A& array, const char* name, int) -> Pointer<typename Bare<decltype(array.data)>::Type>
{
    long long count = 1, stride = sizeof(*array.data);
    for (int i = array.ndim - 1; i >= 0; --i) {
        if (array.shape[i] > 1 && array.strides[i] != stride) refuse(name, -1, -1);  // in pieces: no pointer runs through it
        count *= array.shape[i]; stride *= array.shape[i];
    }
    return {array.data, array.data, count, name};
}
// ... of a matrix
template <class M> inline auto& data(const M& matrix, const char*, long) { return matrix.data; }

}  // namespace checked
