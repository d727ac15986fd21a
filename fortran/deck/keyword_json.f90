!> The keyword table as JSON, for Python and editors.
module lopin_keyword_json
   use lopin_json_writer, only : json_writer_type
   use lopin_keyword_table, only : keyword_table_type, keyword_type, keyword_parameter_type, &
      & keyword_field_type
   use lopin_keywords, only : new_keyword_table
   implicit none
   private
   public :: keywords_json

   character(len=*), parameter :: status_words(3) = [character(len=9) :: 'supported', 'ignored', &
      & 'later']
   character(len=*), parameter :: level_words(4) = [character(len=8) :: 'model', 'part', &
      & 'assembly', 'step']
   character(len=*), parameter :: level_letters = 'MPAS'

contains

   !> A list of objects, one a keyword.
   function keywords_json() result(text)
      character(len=:), allocatable :: text
      type(keyword_table_type) :: table
      type(json_writer_type) :: json
      integer :: i

      call new_keyword_table(table)
      call json%open('[', '')
      do i = 1, table%n
         call add_keyword(json, table%row(i))
      end do
      call json%close(']')
      text = json%text%content()
   end function keywords_json

   subroutine add_keyword(json, row)
      type(json_writer_type), intent(inout) :: json
      type(keyword_type), intent(in) :: row
      integer :: i, k

      call json%open('{', '')
      call json%add('name', row%name)
      call json%add('status', trim(status_words(row%status)))
      call json%add('origin', row%origin)
      call json%open('[', 'places')
      do i = 1, len(level_letters)
         if (index(row%levels, level_letters(i:i)) > 0) call json%add('', &
            & trim(level_words(i)))
      end do
      call json%close(']')
      call json%add('after', row%parents)
      call json%add('sentence', row%sentence)
      call json%open('[', 'parameters')
      do i = 1, size(row%parameter)
         call add_parameter(json, row%parameter(i))
      end do
      call json%close(']')
      call json%open('[', 'data')
      do i = 1, size(row%data)
         call json%open('{', '')
         call json%open('[', 'fields')
         do k = 1, size(row%data(i)%field)
            call add_field(json, row%data(i)%field(k))
         end do
         call json%close(']')
         call json%add('sentence', row%data(i)%sentence)
         call json%add('condition', row%data(i)%condition)
         call json%close('}')
      end do
      call json%close(']')
      call json%add('example', row%example)
      call json%add('reported', merge(1, 0, row%is_reported))
      call json%close('}')
   end subroutine add_keyword

   subroutine add_parameter(json, parameter)
      type(json_writer_type), intent(inout) :: json
      type(keyword_parameter_type), intent(in) :: parameter

      call json%open('{', '')
      call json%add('name', parameter%name)
      call json%add('kind', parameter%kind)
      call json%add('choices', parameter%choices)
      call json%add('respelt', parameter%misspelt)
      call json%add('default', parameter%default)
      call json%add('status', trim(status_words(parameter%status)))
      call json%add('required', merge(1, 0, parameter%is_required))
      call json%add('sentence', parameter%sentence)
      call json%close('}')
   end subroutine add_parameter

   subroutine add_field(json, field)
      type(json_writer_type), intent(inout) :: json
      type(keyword_field_type), intent(in) :: field

      call json%open('{', '')
      call json%add('name', field%name)
      call json%add('unit', field%unit)
      call json%add('default', field%default)
      call json%close('}')
   end subroutine add_field
end module lopin_keyword_json
