!> The memory of points of a mesh that stays as it is while that of another body is made anew: out
!> of a run and into the next part of it, number by number.
!>
!> Such a mesh keeps its coordinates of the start, and its displacements go along (*START): what
!> its points remember belongs to that shape and needs no law to be read. So any element and any law
!> that looks back can stay: internal modes, Hill's ratios, backstress.
module lopin_kept_memory
   use lopin_kinds, only : wp
   use lopin_damage, only : damage_kinds
   use lopin_damage_criteria, only : damage_names
   use lopin_model, only : model_type
   use lopin_start, only : kept_memory_type
   use lopin_state, only : solids_state_type
   implicit none
   private
   public :: memory_of_points, put_kept_memory, kept_rows

   !> Rows of a table before those of the memory: element, point, ln J of stresses of the start,
   !> volume that the law counts by over that of the mesh, damage by criterion.
   integer, parameter :: kept_rows = 4 + size(damage_names)

contains

   !> One column a point that remembers.
   subroutine memory_of_points(memory, model, table)
      type(solids_state_type), intent(in) :: memory
      type(model_type), intent(in) :: model
      real(wp), allocatable, intent(out) :: table(:, :)   !! (kept_rows + memory, ncolumn)
      integer, allocatable :: kinds(:)
      integer :: e, k, n

      n = size(memory%value, 1)
      if (memory%scaled) n = n - 1
      allocate (table(kept_rows + n, size(memory%value, 2)), source=0.0_wp)
      table(3, :) = memory%pressed
      table(4, :) = 1.0_wp
      if (memory%scaled) table(4, :) = memory%value(n + 1, :)
      if (allocated(memory%damage)) then
         allocate (kinds, source=damage_kinds(model))
         table(4 + kinds, :) = memory%damage(1::2, :)
      end if
      table(kept_rows + 1:, :) = memory%value(:n, :)
      do e = 1, model%mesh%nelement
         do k = memory%first(e), memory%first(e + 1) - 1
            table(1, k) = model%mesh%element_label(e)
            table(2, k) = k - memory%first(e) + 1
         end do
      end do
   end subroutine memory_of_points

   !> Into the memory of a point; `found` is false if the element has no such point, or if it
   !> remembers other numbers.
   subroutine put_kept_memory(memory, kept, found)
      type(solids_state_type), intent(inout) :: memory
      type(kept_memory_type), intent(in) :: kept
      logical, intent(out) :: found
      integer :: k, n

      n = size(memory%value, 1)
      if (memory%scaled) n = n - 1
      k = memory%first(kept%element) + kept%point - 1
      found = kept%point > 0 .and. k < memory%first(kept%element + 1) .and. size(kept%value) == n
      if (.not. found) return
      memory%value(:n, k) = kept%value
      if (memory%scaled) memory%value(n + 1, k) = kept%scale
      memory%pressed(k) = kept%pressed
   end subroutine put_kept_memory
end module lopin_kept_memory
