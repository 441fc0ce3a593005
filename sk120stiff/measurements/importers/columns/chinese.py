"""Chinese words of headers in English, as trackers and controllers sold in China write them."""

from __future__ import annotations

import re

_WORDS = {
    "测量": "measured", "实测": "measured", "实际": "actual", "名义": "nominal",
    "理论": "nominal", "标称": "nominal", "目标": "target", "指令": "command",
    "偏差": "deviation", "误差": "error", "坐标": "coordinate", "位置": "position",
    "位移": "displacement", "变形": "deformation", "挠度": "deflection",
    "关节角度": "joint", "关节角": "joint", "关节": "joint", "轴": "axis",
    "名称": "name", "点名": "name", "点号": "name", "编号": "no", "序号": "no", "番号": "no",
    "点": "point", "測点": "point", "测点": "point", "测量点": "point", "測定点": "point",
    "位姿": "pose", "姿态": "posture", "姿勢": "posture",
    "力矩": "moment", "力": "force", "载荷": "load",
    "负载": "payload", "负荷": "load", "质量": "payload", "方向": "direction",
    "温度": "temperature", "时间": "time", "日期": "date", "空载": "unloaded",
    "加载前": "unloaded", "加载后": "loaded", "负载后": "loaded", "卸载": "unloaded",
    "无负载": "unloaded", "有负载": "loaded", "带载": "loaded", "靶球": "marker",
    "站位": "station", "四元数": "quaternion", "标准差": "std", "不确定度": "uncertainty",
}  # fmt: skip
_UNITS = {"毫米": "mm", "微米": "um", "米": "m", "度": "deg", "弧度": "rad", "牛": "N",
          "牛顿": "N", "千克": "kg", "公斤": "kg", "秒": "s"}  # fmt: skip
_MARKS = str.maketrans("（）【】：，／", "()[]:,/")
_CHINESE = re.compile(r"[\u4e00-\u9fff]")
_ANY = re.compile("|".join(sorted(_WORDS, key=len, reverse=True)))
_UNIT = re.compile(rf"([\[(/]\s*)({'|'.join(sorted(_UNITS, key=len, reverse=True))})(?=\s*[\])]|$)")


def in_english(header: str) -> str:
    """The header with its Chinese words as English ones; any other header as it is."""
    if not _CHINESE.search(header):
        return header
    plain = _UNIT.sub(lambda m: m[1] + _UNITS[m[2]], header.translate(_MARKS))
    return " ".join(_ANY.sub(lambda m: f" {_WORDS[m[0]]} ", plain).split())
