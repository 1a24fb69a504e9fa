/* The two checksums of the protocol, bit by bit: no tables in flash, and fast enough for a serial line. */
#ifndef BP_CHECKSUM_H
#define BP_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>

/* CRC-16/IBM-3740 of a frame; over a whole frame, its own checksum included, it is 0. */
uint16_t bp_crc16(const uint8_t *data, size_t size);

/* CRC-32 as zlib's. */
uint32_t bp_crc32(const uint8_t *data, size_t size);

#endif
