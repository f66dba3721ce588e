"""Prints what a zip of npy arrays holds, with the standard library alone: name shape type sum."""

import array
import ast
import sys
import zipfile

with zipfile.ZipFile(sys.argv[1]) as archive:
    assert archive.testzip() is None
    for info in archive.infolist():
        assert info.date_time == (1980, 1, 1, 0, 0, 0), info.date_time
        data = archive.read(info)
        assert data[:8] == b"\x93NUMPY\x01\x00"
        length = int.from_bytes(data[8:10], "little")
        assert (10 + length) % 64 == 0 and data[9 + length:10 + length] == b"\n"
        header = ast.literal_eval(data[10:10 + length].decode("latin1"))
        assert header["fortran_order"] is False
        values = array.array({"<f4": "f", "<u4": "I"}[header["descr"]])
        values.frombytes(data[10 + length:])
        count = 1
        for side in header["shape"]:
            count *= side
        assert count == len(values)
        shape = "x".join(str(side) for side in header["shape"])
        print(info.filename, shape, header["descr"], repr(float(sum(values))))
