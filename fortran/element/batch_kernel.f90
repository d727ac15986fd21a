!> Which of the copies of the kernel of batches a processor takes: the one for vectors of two
!> numbers, which every processor has, that for four (AVX2, wide_solid_batch) or that for eight
!> (AVX-512, wider_solid_batch): the same source, written by CMake under other names. Operations are
!> the same, and none is fused: the same bits.
module lopin_batch_kernel
   use, intrinsic :: iso_c_binding, only : c_int
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_batch, only : batch_type, kept_type, lanes, points
   use lopin_hyperelastic, only : solid_law_type
   use lopin_solid_batch, only : evaluate_batch
   use lopin_batch_end, only : recover_batch, keep_batch
   use wide_solid_batch, only : evaluate_wide => evaluate_batch
   use wide_batch_end, only : recover_wide => recover_batch, keep_wide => keep_batch
   use wider_solid_batch, only : evaluate_wider => evaluate_batch
   use wider_batch_end, only : recover_wider => recover_batch, keep_wider => keep_batch
   implicit none
   private
   public :: compute_batch, compute_stresses, compute_kept, vector_width

   interface
      !> How many numbers the vectors of the processor hold: 2, 4 or 8.
      integer(c_int) function lopin_vector_width() bind(c)
         import :: c_int
      end function lopin_vector_width
   end interface

contains

   !> How many numbers the vectors of the processor hold, `most_wide` at most.
   integer function vector_width(most_wide) result(width)
      integer, intent(in), optional :: most_wide

      width = lopin_vector_width()
      if (present(most_wide)) width = min(width, most_wide)
   end function vector_width

   !> Forces, energies and, if asked for, tangents of a batch.
   subroutine compute_batch(element, law, with_tangent, batch, done, most_wide)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      logical, intent(in) :: with_tangent
      type(batch_type), intent(inout) :: batch
      logical, intent(out) :: done             !! no element is turned inside out
      integer, intent(in), optional :: most_wide   !! vectors

      select case (vector_width(most_wide))
      case (8)
         call evaluate_wider(element, law, with_tangent, batch, done)
      case (4)
         call evaluate_wide(element, law, with_tangent, batch, done)
      case default
         call evaluate_batch(element, law, with_tangent, batch, done)
      end select
   end subroutine compute_batch

   !> Cauchy stresses and logarithmic strains at the points of a batch.
   subroutine compute_stresses(element, law, batch, stress, strain, done, most_wide)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      type(batch_type), intent(in) :: batch
      real(wp), intent(out) :: stress(lanes, 6, points), strain(lanes, 6, points)
      logical, intent(out) :: done             !! no element is turned inside out
      integer, intent(in), optional :: most_wide   !! vectors

      select case (vector_width(most_wide))
      case (8)
         call recover_wider(element, law, batch, stress, strain, done)
      case (4)
         call recover_wide(element, law, batch, stress, strain, done)
      case default
         call recover_batch(element, law, batch, stress, strain, done)
      end select
   end subroutine compute_stresses

   !> What the points of a batch keep of an increment.
   subroutine compute_kept(element, law, batch, kept, done, most_wide)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      type(batch_type), intent(in) :: batch
      type(kept_type), intent(inout) :: kept
      logical, intent(out) :: done             !! no element is turned inside out
      integer, intent(in), optional :: most_wide   !! vectors

      select case (vector_width(most_wide))
      case (8)
         call keep_wider(element, law, batch, kept, done)
      case (4)
         call keep_wide(element, law, batch, kept, done)
      case default
         call keep_batch(element, law, batch, kept, done)
      end select
   end subroutine compute_kept
end module lopin_batch_kernel
