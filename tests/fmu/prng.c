/* bcryptprimitives.dll as Windows has it, for Wine 8.0, which lacks it: Rust's standard library asks it for random numbers. */
#include <windows.h>

#include <ntsecapi.h>

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE data, SIZE_T size) {
    return RtlGenRandom(data, (ULONG)size);
}
