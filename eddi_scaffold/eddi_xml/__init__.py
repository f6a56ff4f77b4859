"""Readers: bytes in, trees and problems out. They know no monitor kind and print nothing."""
