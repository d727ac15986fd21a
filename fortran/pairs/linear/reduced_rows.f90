!> Contact rows on the free equations, and what forces of rows do to the nodes.
module lopin_reduced_rows
   use lopin_kinds, only : wp
   use lopin_constraints, only : constraints_type
   use lopin_contact_rows, only : contact_rows_type
   implicit none
   private
   public :: reduce_rows, row_forces

contains

   !> Rows that are solved for, on the free equations, and what prescribed displacements (in
   !> `u_known`) do to the gaps.
   subroutine reduce_rows(self, constraints, u_known, first, equation, value, gap)
      type(contact_rows_type), intent(in) :: self
      type(constraints_type), intent(in) :: constraints
      real(wp), intent(in) :: u_known(:)   !! (ndof) displacements with all equations zero
      integer, allocatable, intent(out) :: first(:), equation(:)
      real(wp), allocatable, intent(out) :: value(:), gap(:)
      integer :: row, k, c, m, from, total
      integer, allocatable :: seen(:)

      total = 0
      do k = 1, self%first(self%nsolved + 1) - 1
         total = total + constraints%first(self%dof(k) + 1) - constraints%first(self%dof(k))
      end do
      allocate (first(self%nsolved + 1), equation(total), seen(constraints%neq), source=0)
      allocate (value(total), source=0.0_wp)
      allocate (gap, source=self%gap0(:self%nsolved))
      m = 0
      first(1) = 1
      do row = 1, self%nsolved
         from = m + 1
         do k = self%first(row), self%first(row + 1) - 1
            gap(row) = gap(row) + self%coefficient(k)*u_known(self%dof(k))
            do c = constraints%first(self%dof(k)), constraints%first(self%dof(k) + 1) - 1
               call add(constraints%equation(c), self%coefficient(k)*constraints%coefficient(c))
            end do
         end do
         first(row + 1) = m + 1
      end do
      equation = equation(:m)
      value = value(:m)

   contains

      !> To the row at hand, whose terms begin at `from`.
      subroutine add(eq, part)
         integer, intent(in) :: eq
         real(wp), intent(in) :: part

         if (seen(eq) < from) then
            m = m + 1
            seen(eq) = m
            equation(m) = eq
            value(m) = 0.0_wp
         end if
         value(seen(eq)) = value(seen(eq)) + part
      end subroutine add
   end subroutine reduce_rows

   !> Forces on the physical dofs from forces of the rows.
   pure subroutine row_forces(self, force, f)
      type(contact_rows_type), intent(in) :: self
      real(wp), intent(in) :: force(:)       !! (n) [force]
      real(wp), intent(inout) :: f(:)        !! (ndof) added to
      integer :: row, k

      do row = 1, self%n
         do k = self%first(row), self%first(row + 1) - 1
            f(self%dof(k)) = f(self%dof(k)) + self%coefficient(k)*force(row)
         end do
      end do
   end subroutine row_forces
end module lopin_reduced_rows
