/* A stand-in for a library that every Windows since 7 has and wine 8 has not: random numbers, which the program's
   standard library asks for at its start. Beside the program it lets it run under wine. */
#include <windows.h>

BOOLEAN NTAPI SystemFunction036(PVOID data, ULONG length);

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE data, SIZE_T length) {
    return SystemFunction036(data, (ULONG)length);
}
