/* FNV-1a with 64 bits: the hash goes on with more bytes, or with words of four bytes. */
#include <stdint.h>
#include <string.h>

static const uint64_t prime = 0x100000001b3u;

/* The bytes of n numbers, least significant first. Zeros, as across a plane model, change nothing
 * but by the powers of the prime: eight of them are one product. */
uint64_t lopin_hash_reals(uint64_t hash, const double *x, int64_t n)
{
    uint64_t eighth = prime * prime;
    eighth *= eighth;
    eighth *= eighth;
    for (int64_t i = 0; i < n; i++) {
        uint64_t bits;
        memcpy(&bits, x + i, sizeof bits);
        if (!bits) {
            hash *= eighth;
            continue;
        }
        for (int k = 0; k < 8; k++, bits >>= 8) hash = (hash ^ (bits & 255u)) * prime;
    }
    return hash;
}

/* n bytes, four at a time, and what is left one by one. */
uint64_t lopin_hash_bytes(uint64_t hash, const unsigned char *bytes, int64_t n)
{
    int64_t i = 0;
    for (; i + 4 <= n; i += 4) {
        uint32_t word;
        memcpy(&word, bytes + i, sizeof word);
        hash = (hash ^ word) * prime;
    }
    for (; i < n; i++) hash = (hash ^ bytes[i]) * prime;
    return hash;
}
