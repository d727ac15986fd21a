!> What the values of a contact row show before its slopes are asked for.
module lopin_clear_rows
   use lopin_kinds, only : wp
   use lopin_contact_row, only : point_law_type
   use lopin_nonlinear_samples, only : row_value
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_touch_onset, only : may_touch
   implicit none
   private
   public :: shift_of, is_clear, is_alone, reads_tool

contains

   !> Added to the gap of a row: ADJUST, CLEARANCE, and overclosures that are not yet applied.
   pure real(wp) function shift_of(self, i)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i

      if (self%share(i) > 0.0_wp) then
         shift_of = row_value(self, i, self%shift) &
            & + (1.0_wp - self%interference)*row_value(self, i, self%overclosure)
         if (.not. allocated(self%opposite(i)%inner)) shift_of = shift_of &
            & + (1.0_wp - self%early_share)*self%early(i)
      else
         shift_of = self%shift(i) + (1.0_wp - self%interference)*self%overclosure(i)
      end if
   end function shift_of

   !> A row that its values already show to be open: its slopes, which cost most of it, are not
   !> needed.
   pure logical function is_clear(self, i, law)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      type(point_law_type), intent(in) :: law
      real(wp) :: along, gap

      is_clear = .false.
      associate (g => self%enforcement(i), o => self%opposite(i))
         if (g%bilateral .or. g%tied .or. .not. g%method%solves_for_multiplier()) return
         if (.not. self%mortar(self%pair(i))%is_on) then
            ! Of tools that are solved for, rows keep their pattern.
            if (.not. is_alone(self, i, law) .or. reads_tool(self, i, law)) return
            if (may_touch(self, i)) return
         end if
         along = dot_product(law%lambda, o%normal)
         gap = o%foot%gap + law%shift + g%method%penetration(along, g%slope)
         if (g%method%updates()) gap = gap &
            & - g%method%penetration(dot_product(g%frozen, o%normal), g%slope)
         is_clear = along - g%c*gap < -g%grazing .and. gap > 0.0_wp
      end associate
   end function is_clear

   !> The row of a node alone: at its own place, opposite a tool that does not turn while slopes are
   !> read, none of them in the areas of facets.
   pure logical function is_alone(self, i, law)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      type(point_law_type), intent(in) :: law

      is_alone = .false.
      associate (m => self%masters%of(self%pair(i)), o => self%opposite(i))
         if (m%tool == 0 .or. m%floats) return
         if (law%with_tangent .and. m%turns .and. .not. self%has_arrived) return
         if (law%with_tangent .and. (law%follows .or. allocated(self%growth(i)%slope))) return
         if (self%mortar(self%pair(i))%is_on .or. self%mortar_anchor(i)%tie%set) return
         is_alone = .not. (allocated(o%sample) .or. allocated(o%inner) .or. &
            & self%enforcement(i)%tied)
      end associate
   end function is_alone

   !> Slopes in the place of the tool are asked for.
   pure logical function reads_tool(self, i, law)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      type(point_law_type), intent(in) :: law

      reads_tool = law%with_tangent .and. .not. (self%has_arrived .and. &
         & self%masters%of(self%pair(i))%held)
   end function reads_tool
end module lopin_clear_rows
