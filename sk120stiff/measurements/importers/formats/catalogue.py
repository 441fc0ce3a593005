"""The formats that are known."""

from sk120stiff.measurements.importers.contract import Formats
from sk120stiff.measurements.importers.formats.figaroh import Figaroh
from sk120stiff.measurements.importers.formats.joint_tables import DELMIA, ROBODK
from sk120stiff.measurements.importers.formats.leica import Leica
from sk120stiff.measurements.importers.formats.points import Points
from sk120stiff.measurements.importers.formats.polyworks import PolyWorks
from sk120stiff.measurements.importers.formats.ros_bag import RosBag
from sk120stiff.measurements.importers.formats.spatial_analyzer import SpatialAnalyzer

FORMATS = Formats(
    (RosBag(), SpatialAnalyzer(), Leica(), PolyWorks(), ROBODK, DELMIA, Figaroh(), Points())
)
