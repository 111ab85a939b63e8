"""The only folder that imports OCP, the Python binding of the OCCT geometry kernel.

`load` reads STEP and BREP as the parts of `part`, `section` cuts them by planes, `wires` and `step`
turn layers into B-rep and write it.
"""

from v3dcad.errors import MissingKernelError

try:
    from OCP.Message import Message
except ImportError as error:
    if isinstance(error.__cause__, (KeyboardInterrupt, SystemExit)):  # a signal came meanwhile
        raise error.__cause__ from None
    if "libGL" in str(error):
        raise MissingKernelError(
            "the geometry kernel needs the system library libGL.so.1: "
            "run `apt-get install -y libgl1` (or your system's package of libGL), then try again"
        ) from error
    raise MissingKernelError(
        f"the geometry kernel OCP cannot be imported ({error}): "
        "run `pip install 'v3dcad[occt]'`, then try again"
    ) from error

# OCCT's own messages are not printed; what matters is raised as an error.
Message.DefaultMessenger_s().ChangePrinters().Clear()
