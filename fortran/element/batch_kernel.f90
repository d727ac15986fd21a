!> Which of the two copies of the kernel of batches a processor takes: the one for vectors of two
!> numbers, which every processor has, or that for four (AVX2, wide_solid_batch: the same source,
!> written by CMake under another name). Operations are the same, and none is fused: the same bits.
module lopin_batch_kernel
   use, intrinsic :: iso_c_binding, only : c_int
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_batch, only : batch_type, kept_type, lanes, most
   use lopin_hyperelastic, only : solid_law_type
   use lopin_solid_batch, only : evaluate_batch
   use lopin_batch_end, only : recover_batch, keep_batch
   use wide_solid_batch, only : evaluate_wide => evaluate_batch
   use wide_batch_end, only : recover_wide => recover_batch, keep_wide => keep_batch
   implicit none
   private
   public :: compute_batch, compute_stresses, compute_kept, has_wide_vectors

   interface
      integer(c_int) function lopin_has_wide_vectors() bind(c)
         import :: c_int
      end function lopin_has_wide_vectors
   end interface

contains

   !> The processor computes four numbers at a time.
   logical function has_wide_vectors()
      has_wide_vectors = lopin_has_wide_vectors() /= 0
   end function has_wide_vectors

   !> Forces, energies and, if asked for, tangents of a batch.
   subroutine compute_batch(element, law, with_tangent, batch, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      logical, intent(in) :: with_tangent
      type(batch_type), intent(inout) :: batch
      logical, intent(out) :: done             !! no element is turned inside out

      if (has_wide_vectors()) then
         call evaluate_wide(element, law, with_tangent, batch, done)
      else
         call evaluate_batch(element, law, with_tangent, batch, done)
      end if
   end subroutine compute_batch

   !> Cauchy stresses and logarithmic strains at the points of a batch.
   subroutine compute_stresses(element, law, batch, stress, strain, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      type(batch_type), intent(in) :: batch
      real(wp), intent(out) :: stress(lanes, 6, most), strain(lanes, 6, most)
      logical, intent(out) :: done             !! no element is turned inside out

      if (has_wide_vectors()) then
         call recover_wide(element, law, batch, stress, strain, done)
      else
         call recover_batch(element, law, batch, stress, strain, done)
      end if
   end subroutine compute_stresses

   !> What the points of a batch keep of an increment.
   subroutine compute_kept(element, law, batch, kept, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      type(batch_type), intent(in) :: batch
      type(kept_type), intent(inout) :: kept
      logical, intent(out) :: done             !! no element is turned inside out

      if (has_wide_vectors()) then
         call keep_wide(element, law, batch, kept, done)
      else
         call keep_batch(element, law, batch, kept, done)
      end if
   end subroutine compute_kept
end module lopin_batch_kernel
